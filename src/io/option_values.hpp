// Strict reading and shortest exact writing of option values: what each type of member accepts.
#pragma once

#include "grid/box.hpp"

#include <array>
#include <limits>
#include <string>
#include <vector>

namespace eulastic {

/// Numbers below `low` (or equal to it if `open`) are refused.
struct Range {
  double low;
  bool open;
  double high = std::numeric_limits<double>::infinity();
  bool contains(double value) const { return (open ? value > low : value >= low) && value <= high; }
  std::string text() const;  ///< " > 0", or nothing when unbounded
};
extern const Range any_number, positive, not_negative, at_least_one;

/// All `read_*` return what is wrong, or nothing; the targets are written only when all is well.
std::string read_numbers(const std::string &text, const Range &range, double *target, std::size_t count);
std::string read_numbers(const std::string &text, const Range &range, int *target, std::size_t count);
std::string read_numbers(const std::string &text, const Range &range, long *target, std::size_t count);
std::string read_boolean(const std::string &text, bool *target);
/// Index into `names`.
std::string read_choice(const std::string &text, const std::vector<std::string> &names, int *target);
/// Comma-separated words, each one of `names` unless that is empty, none twice.
std::string read_words(const std::string &text, const std::vector<std::string> &names,
                       std::vector<std::string> *target);
/// Points x,y,z separated by colons.
std::string read_points(const std::string &text, std::vector<std::array<double, 3>> *target);
/// A path: no quotes, no control characters.
std::string read_text(const std::string &text, std::string *target);

/// Shortest decimal that reads back as the same double.
std::string to_text(double value);
std::string join(const std::vector<std::string> &items, const char *separator);
bool is_boolean_word(const std::string &text);

}  // namespace eulastic
