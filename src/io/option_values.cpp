#include "io/option_values.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>

namespace eulastic {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

std::string quoted(const std::string &text) { return '"' + text + '"'; }

std::vector<std::string> split(const std::string &text, char separator = ',') {
  std::vector<std::string> items(1);
  for (char c : text) {
    if (c == separator)
      items.emplace_back();
    else
      items.back() += c;
  }
  return items;
}

// The whole of `item` as one number, or what is wrong.
template <class T>
std::string read_number(const std::string &item, const Range &range, T *target) {
  const char *begin = item.data(), *end = begin + item.size();
  if (item.size() > 1 && item[0] == '+' && item[1] != '-') ++begin;
  T value{};
  const auto [stop, status] = std::from_chars(begin, end, value);
  if (status == std::errc::result_out_of_range) return quoted(item) + " does not fit into a number of this kind";
  if (status != std::errc{} || stop != end)
    return quoted(item) + (std::is_integral_v<T> ? " is not an integer" : " is not a number");
  if (!std::isfinite(static_cast<double>(value))) return quoted(item) + " is not finite";
  if (!range.contains(static_cast<double>(value))) return quoted(item) + " is out of range";
  *target = value;
  return {};
}

template <class T>
std::string read_list(const std::string &text, const Range &range, T *target, std::size_t count) {
  const std::vector<std::string> items = split(text);
  std::vector<T> values(items.size());
  for (std::size_t i = 0; i < items.size(); ++i) {
    if (items[i].empty()) return "empty item in " + quoted(text);
    if (const std::string wrong = read_number(items[i], range, &values[i]); !wrong.empty()) return wrong;
  }
  if (items.size() != count) return quoted(text) + " has " + std::to_string(items.size()) + " items";
  std::copy(values.begin(), values.end(), target);
  return {};
}

}  // namespace

const Range any_number{-infinity, false}, positive{0, true}, not_negative{0, false}, at_least_one{1, false};

std::string Range::text() const {
  std::string text;
  if (low > -infinity) text += (open ? " > " : " >= ") + to_text(low);
  if (high < infinity) text += (text.empty() ? " <= " : " and <= ") + to_text(high);
  return text;
}

std::string read_numbers(const std::string &text, const Range &range, double *target, std::size_t count) {
  return read_list(text, range, target, count);
}

std::string read_points(const std::string &text, std::vector<std::array<double, 3>> *target) {
  std::vector<std::array<double, 3>> points;
  for (const std::string &item : split(text, ':'))
    if (const std::string wrong = read_list(item, any_number, points.emplace_back().data(), 3); !wrong.empty())
      return wrong;
  *target = points;
  return {};
}

std::string read_numbers(const std::string &text, const Range &range, int *target, std::size_t count) {
  return read_list(text, range, target, count);
}

std::string read_numbers(const std::string &text, const Range &range, long *target, std::size_t count) {
  return read_list(text, range, target, count);
}

bool is_boolean_word(const std::string &text) {
  bool ignored;
  return read_boolean(text, &ignored).empty();
}

std::string read_boolean(const std::string &text, bool *target) {
  const bool yes = text == "true" || text == "yes" || text == "1";
  if (!yes && text != "false" && text != "no" && text != "0") return quoted(text) + " is neither true nor false";
  *target = yes;
  return {};
}

std::string read_choice(const std::string &text, const std::vector<std::string> &names, int *target) {
  const auto found = std::find(names.begin(), names.end(), text);
  if (found == names.end()) return quoted(text) + " is not a choice";
  *target = static_cast<int>(found - names.begin());
  return {};
}

std::string read_words(const std::string &text, const std::vector<std::string> &names,
                       std::vector<std::string> *target) {
  const std::vector<std::string> items = split(text);
  for (auto item = items.begin(); item != items.end(); ++item) {
    if (item->empty()) return "empty item in " + quoted(text);
    if (std::find(items.begin(), item, *item) != item) return quoted(*item) + " is given twice";
    int ignored;
    if (names.empty()) continue;
    if (const std::string wrong = read_choice(*item, names, &ignored); !wrong.empty()) return wrong;
  }
  *target = items;
  return {};
}

std::string read_text(const std::string &text, std::string *target) {
  for (unsigned char c : text)
    if (c < 0x20 || c == 0x7f) return "a control character in the value";
  *target = text;
  return {};
}

std::string to_text(double value) {
  char buffer[32];
  return std::string(buffer, std::to_chars(buffer, buffer + sizeof buffer, value).ptr);
}

std::string join(const std::vector<std::string> &items, const char *separator) {
  std::string text;
  for (const std::string &item : items) text += (text.empty() ? "" : separator) + item;
  return text;
}

}  // namespace eulastic
