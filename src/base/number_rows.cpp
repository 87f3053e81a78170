#include "base/number_rows.hpp"

#include "base/one_line.hpp"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>

namespace eulastic {
namespace {

using Items = std::vector<std::string_view>;

constexpr std::string_view blanks = " \t\r\v\f";

std::string_view trim(std::string_view text) {
  const std::size_t first = text.find_first_not_of(blanks);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(blanks) - first + 1);
}

Items split(std::string_view line) {
  Items items;
  const char separator = line.find(';') != line.npos ? ';' : line.find(',') != line.npos ? ',' : ' ';
  for (std::size_t begin = 0; begin <= line.size();) {
    const std::size_t end =
        std::min(line.size(), separator == ' ' ? line.find_first_of(blanks, begin) : line.find(separator, begin));
    const std::string_view item = trim(line.substr(begin, end - begin));
    if (separator != ' ' || !item.empty()) items.push_back(item);
    begin = end + 1;
  }
  return items;
}

std::string quoted(std::string_view item) {
  constexpr std::size_t longest = 40;
  std::string text(item.substr(0, longest));
  for (char &c : text)
    if (static_cast<unsigned char>(c) < 0x20 || static_cast<unsigned char>(c) >= 0x7f || c == '"') c = '?';
  return '"' + text + (item.size() > longest ? "...\"" : "\"");
}

// Whether an item of the first line may be the name of a column.
bool is_name(std::string_view item) {
  double number;
  return !item.empty() && static_cast<unsigned char>(item[0]) > ' ' &&
         std::string_view("+-.0123456789").find(item[0]) == std::string_view::npos && !read_number(item, &number);
}

std::string name_of(std::string_view item) {
  while (!item.empty() && item.front() == '"') item.remove_prefix(1);
  while (!item.empty() && item.back() == '"') item.remove_suffix(1);
  return lower_case(std::string(trim(item)));
}

// Whether a comment begins with the word `name`, regardless of case.
bool begins_with(std::string_view comment, const std::string &name) {
  return lower_case(std::string(comment.substr(0, name.size()))) == name &&
         (comment.size() == name.size() || !std::isalpha(static_cast<unsigned char>(comment[name.size()])));
}

class RowReader {
public:
  RowReader(const RowFormat &format, const VisitRow &visit) : format_(format), visit_(visit) {}

  /// Reads a line without its comment. Returns the error, or an empty string.
  std::string read_line(std::string_view line, long number) {
    const Items items = split(line);
    if (rows_ == 0 && std::all_of(items.begin(), items.end(), is_name)) return check_header(items);
    row_.clear();
    for (const std::string_view item : items) {
      double value;
      if (item.empty()) return "an item is empty";
      if (!read_number(item, &value)) return quoted(item) + " is not a number";
      if (!std::isfinite(value)) return quoted(item) + " is not finite";
      row_.push_back(value);
    }
    if (format_.counted && rows_ == 0 && count_line_ == 0 && row_.size() == 1) {
      if (!(row_[0] >= 0 && row_[0] == std::floor(row_[0]))) return quoted(items[0]) + " is not a number of rows";
      count_line_ = number;
      count_ = row_[0];
      return {};
    }
    const std::vector<std::size_t> &widths = format_.widths;
    if (!widths.empty() && std::find(widths.begin(), widths.end(), row_.size()) == widths.end())
      return "a row has " + std::to_string(row_.size()) + (row_.size() == 1 ? " number" : " numbers");
    ++rows_;
    return visit_(row_);
  }

  /// Reads a comment line and sets *named if it is the one that the format names. Returns the error, or an empty
  /// string.
  std::string read_comment(std::string_view comment, double *named) {
    if (format_.named.empty() || !begins_with(comment, format_.named)) return {};
    double value;
    if (named_ || !read_number(trim(comment.substr(format_.named.size())), &value) || !(value > 0) ||
        !std::isfinite(value))
      return quoted(comment) + (named_ ? " is repeated" : " gives no number > 0") + "; accepted: one line # " +
             format_.named + " T with a number T > 0, or other comments";
    *named = value;
    named_ = true;
    return {};
  }

  /// Checks the whole text after its last line. Returns the error, or an empty string, and sets *line to the line of
  /// the error, 0 if the error concerns no single line.
  std::string end(long *line) const {
    *line = 0;
    if (rows_ == 0) return "holds no numbers";
    if (count_line_ == 0 || count_ == double(rows_)) return {};
    *line = count_line_;
    return "says that " + std::to_string(static_cast<long long>(std::min(count_, 1e18))) + " rows follow, but " +
           std::to_string(rows_) + " do";
  }

private:
  std::string check_header(const Items &items) const {
    for (std::size_t n = 0; n < items.size(); ++n) {
      const std::string name = name_of(items[n]);
      const auto column = std::find(format_.columns.begin(), format_.columns.end(), name);
      if (column != format_.columns.end() && column != format_.columns.begin() + static_cast<std::ptrdiff_t>(n))
        return "column " + name + " is number " + std::to_string(n + 1);
    }
    return {};
  }

  const RowFormat &format_;
  const VisitRow &visit_;
  std::vector<double> row_;
  std::size_t rows_ = 0;
  bool named_ = false;
  long count_line_ = 0;
  double count_ = 0;
};

}  // namespace

bool read_number(std::string_view word, double *number) {
  const char *begin = word.data(), *end = begin + word.size();
  if (word.size() > 1 && word[0] == '+' && word[1] != '-') ++begin;
  const auto [stop, status] = std::from_chars(begin, end, *number);
  return status == std::errc{} && stop == end;
}

std::size_t byte_order_mark_length(std::string_view text) { return text.compare(0, 3, "\xEF\xBB\xBF") == 0 ? 3 : 0; }

std::string read_rows(const std::string &path, const std::string &text, const RowFormat &format, const VisitRow &visit,
                      double *named) {
  RowReader reader(format, visit);
  const auto name_line = [&](long line, const std::string &wrong) {
    return path + (line > 0 ? " line " + std::to_string(line) + ": " : " ") + wrong;
  };
  const auto refuse = [&](long line, const std::string &wrong) {
    return name_line(line, wrong) + "; accepted: " + format.expected;
  };
  long number = 0;
  for (std::size_t begin = byte_order_mark_length(text); begin < text.size();) {
    const std::size_t end = std::min(text.size(), text.find('\n', begin));
    std::string_view line(text.data() + begin, end - begin);
    begin = end + 1;
    ++number;
    line = trim(line);
    if (named && !line.empty() && line[0] == '#')
      if (const std::string wrong = reader.read_comment(trim(line.substr(1)), named); !wrong.empty())
        return name_line(number, wrong);
    line = trim(line.substr(0, line.find('#')));
    if (line.empty()) continue;
    if (const std::string wrong = reader.read_line(line, number); !wrong.empty()) return refuse(number, wrong);
  }
  const std::string wrong = reader.end(&number);
  return wrong.empty() ? wrong : refuse(number, wrong);
}

}  // namespace eulastic
