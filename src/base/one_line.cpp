#include "base/one_line.hpp"

#include <cctype>
#include <cstdarg>
#include <cstdio>

namespace eulastic {
namespace {

// Returns the length in bytes of the UTF-8 character that begins at `at`; 0 if none begins there or if it is a control
// character.
std::size_t character_bytes(const std::string &text, std::size_t at) {
  const auto byte = [&](std::size_t n) { return n < text.size() ? static_cast<unsigned char>(text[n]) : 0U; };
  const unsigned first = byte(at);
  if (first < 0x80) return first >= 0x20 && first != 0x7f ? 1 : 0;
  const std::size_t length = first >= 0xc2 && first < 0xe0 ? 2 : first >= 0xe0 && first < 0xf0 ? 3 : 4;
  if (first < 0xc2 || first > 0xf4) return 0;
  for (std::size_t n = 1; n < length; ++n)
    if ((byte(at + n) & 0xc0U) != 0x80) return 0;
  const bool control = first == 0xc2 && byte(at + 1) < 0xa0;
  return control ? 0 : length;
}

}  // namespace

std::string print(const char *format, ...) {
  char text[1001];
  va_list list;
  va_start(list, format);
  std::vsnprintf(text, sizeof text, format, list);
  va_end(list);
  return text;
}

std::string lower_case(std::string text) {
  for (char &c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return text;
}

std::string one_line(std::string text) {
  constexpr std::size_t longest = 1000;
  if (const std::size_t length = text.size(); length > longest) text.replace(longest / 2, length - longest, " ... ");
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t bytes = character_bytes(text, at);
    if (bytes == 0) text[at] = '?';
    at += bytes == 0 ? 1 : bytes;
  }
  return text;
}

}  // namespace eulastic
