// Seeded choices, and texts and bytes that have gone wrong.
#pragma once

#include <random>
#include <string>
#include <vector>

namespace eulastic::fuzz {

inline unsigned long seed_of_case(unsigned long seed, long n) { return seed * 1000003 + static_cast<unsigned long>(n); }

class Dice {
public:
  explicit Dice(unsigned long seed) : engine_(seed) {}
  /// 0 ... n - 1
  std::size_t below(std::size_t n) { return n > 0 ? engine_() % n : 0; }
  bool one_in(std::size_t n) { return below(n) == 0; }
  template <class T>
  const T &of(const std::vector<T> &items) {
    return items[below(items.size())];
  }

  /// Some bytes changed, removed, doubled; sometimes cut short.
  std::string spoil(std::string text, std::size_t most = 4) {
    static const std::vector<std::string> pieces{"\"", "#",    "\n",   "\r\n", "\t",  ",",     ":",
                                                 "-",  ".",    "e",    "0",    "nan", "1e999", " ",
                                                 "\\", "\x01", "\xff", "%n%s", "=",   "'",     std::string(1, '\0')};
    for (std::size_t n = 1 + below(most); n > 0; --n) {
      const std::size_t at = below(text.size() + 1), length = below(std::min<std::size_t>(text.size() - at + 1, 40));
      switch (below(6)) {
        case 0:
          text.insert(at, of(pieces));
          break;
        case 1:
          text.erase(at, length);
          break;
        case 2:
          text.insert(at, text.substr(at, length));
          break;
        case 3:
          if (at < text.size()) text[at] = static_cast<char>(below(256));
          break;
        case 4:
          if (at < text.size()) text[at] ^= static_cast<char>(1 << below(8));
          break;
        default:
          if (one_in(4)) text.resize(at);
      }
    }
    return text;
  }

  /// Some bits turned; sometimes cut short.
  std::string damage(std::string bytes) {
    if (one_in(8)) bytes.resize(below(bytes.size()));
    for (std::size_t n = 1 + below(3); n > 0 && !bytes.empty(); --n)
      bytes[below(bytes.size())] ^= static_cast<char>(1 << below(8));
    return bytes;
  }

private:
  std::mt19937_64 engine_;
};

}  // namespace eulastic::fuzz
