// Reads texts of numbers: tables over time, lists of positions and profiles share one grammar (docs/howto/numbers.md).
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace eulastic {

/// Reads the whole of `word` as one number and returns whether it is one. Infinity and NaN count as numbers.
bool read_number(std::string_view word, double *number);

/// Returns the length in bytes of the UTF-8 byte-order mark at the begin of `text`: 3, or 0 if there is none.
std::size_t byte_order_mark_length(std::string_view text);

/// The accepted content of a text of numbers.
struct RowFormat {
  std::string expected;              ///< for error messages, such as "rows of time,value"
  std::vector<std::string> columns;  ///< names of the columns; a header that uses them must have them in this order
  std::vector<std::size_t> widths;   ///< accepted numbers of values per row; empty: any
  bool counted = false;              ///< the first row may hold one integer, the number of the rows that follow
  std::string named{};  ///< NAME of the comment line "# NAME T" that gives a number T > 0; empty: no such line
};

/// Processes a row and returns its error, or an empty string.
using VisitRow = std::function<std::string(const std::vector<double> &row)>;

/// Passes every row of `text` to `visit`. Semicolons separate the numbers of a line; in a line without semicolons
/// commas do, in a line without both, blanks. # begins a comment. Empty lines, lines of words before the first number
/// (a header), a byte-order mark and carriage returns are skipped. `named` is set if the text has the comment that
/// `format.named` describes. Returns one line that names file, line, error and accepted input, or an empty string.
std::string read_rows(const std::string &path, const std::string &text, const RowFormat &format, const VisitRow &visit,
                      double *named = nullptr);

}  // namespace eulastic
