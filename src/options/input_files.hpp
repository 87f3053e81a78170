// Input files of a case, identified by a hash of their content.
#pragma once

#include "scene/config.hpp"

#include <string>
#include <vector>

namespace eulastic {

struct InputFile {
  std::string option;   ///< that names it, without the dash
  std::string path;     ///< as in options.txt
  std::string content;  ///< 16 hexadecimal digits: the same bytes give the same digits
};

/// Collective. All files that the options of `config` name, in the order of the options; rank 0 reads them.
std::vector<InputFile> hash_input_files(const Config &config);

/// Begins the line of options.txt, below that of the option, with the hash of its file.
inline const std::string content_mark = "# content ";

}  // namespace eulastic
