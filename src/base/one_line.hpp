// Texts: lines that a terminal shows, printed numbers, letters in lower case.
#pragma once

#include <string>

namespace eulastic {

/// `text` with ? in place of every control character and of every byte that is not UTF-8, and with its middle left out
/// if it has more than 1000 bytes.
std::string one_line(std::string text);

/// What printf() prints, at most 1000 bytes.
__attribute__((format(printf, 1, 2))) std::string print(const char *format, ...);

/// ASCII letters in lower case.
std::string lower_case(std::string text);

}  // namespace eulastic
