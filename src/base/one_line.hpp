// Makes text of any origin printable as one line, prints numbers into text, and lower-case text.
#pragma once

#include <string>

namespace eulastic {

/// Returns `text` with every control character and every byte that is not UTF-8 replaced by ?, and shortened in the
/// middle if it has more than 1000 bytes.
std::string one_line(std::string text);

/// What printf() prints, at most 1000 bytes.
__attribute__((format(printf, 1, 2))) std::string print(const char *format, ...);

/// ASCII letters in lower case.
std::string lower_case(std::string text);

}  // namespace eulastic
