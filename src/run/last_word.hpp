// What a run says at its start and at its end.
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

/// One line: what runs, and where it writes.
std::string first_word(const Config &config, int ranks);
/// One line: why it ended, where, where the results are, and the command that goes on with it, for a shell in the
/// directory in which it was started.
std::string last_word(const ParseResult &parsed, const Ending &end);

}  // namespace eulastic
