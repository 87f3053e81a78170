// Texts of numbers: one grammar for tables over time, lists of positions and profiles (docs/howto/numbers.md).
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace eulastic {

/// Reads all of `word` as one number; returns false if it is none. Infinity and nan are numbers here.
bool read_number(std::string_view word, double *number);

/// How many bytes of a text are its byte-order mark (of UTF-8): 3, or 0 where it has none.
std::size_t mark_length(std::string_view text);

/// What a text of numbers holds.
struct RowFormat {
  std::string expected;              ///< for messages, such as "rows of time,value"
  std::vector<std::string> columns;  ///< a header that uses these names must have them in this order
  std::vector<std::size_t> widths;   ///< how many numbers a row may have; empty: any
  bool counted = false;              ///< a first row of one integer is the number of the rows that follow
  std::string named{};               ///< a comment line "# NAME T" of this name gives a number T > 0; empty: none does
};

/// Returns what is wrong with a row, or nothing.
using VisitRow = std::function<std::string(const std::vector<double> &row)>;

/// Passes every row of `text` to `visit`. Semicolons separate the numbers of a line; in a line without them commas do;
/// in a line without both, blanks. # begins a comment; empty lines, lines of words before the first number (a header),
/// a byte-order mark and carriage returns are skipped. `named`: set to the number of the comment that `format` names,
/// if there is one. Returns one line that names file and line and says what is wrong and what was expected, or nothing.
std::string read_rows(const std::string &path, const std::string &text, const RowFormat &format, const VisitRow &visit,
                      double *named = nullptr);

}  // namespace eulastic
