// First and last line of a run.
#pragma once

#include "options/parse_options.hpp"

#include <cstdint>

namespace eulastic {

struct Ending {
  std::string reason;  ///< exit_reason of summary.json
  double time = 0;
  std::int64_t step = 0;
  int ranks = 1;
  std::string checkpoint;  ///< newest one in the directory, or empty
};

/// One line with the version, the size and the output directory.
std::string first_word(const Config &config, int ranks);
/// One line: the reason of the end, time and step, the output directory, and the command that continues the run, for a
/// shell in the directory in which it was started.
std::string last_word(const ParseResult &parsed, const Ending &end);

}  // namespace eulastic
