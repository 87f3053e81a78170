// Makes text of any origin printable as one line.
#pragma once

#include <string>

namespace eulastic {

/// Returns `text` with every control character and every byte that is not UTF-8 replaced by ?, and shortened in the
/// middle if it has more than 1000 bytes.
std::string one_line(std::string text);

}  // namespace eulastic
