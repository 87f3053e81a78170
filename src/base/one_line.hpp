// Text of any origin as one line that a terminal shows.
#pragma once

#include <string>

namespace eulastic {

/// `text` with ? in place of every control character and of every byte that is not UTF-8, and with its middle left out
/// if it has more than 1000 bytes.
std::string one_line(std::string text);

}  // namespace eulastic
