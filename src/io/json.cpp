#include "io/json.hpp"

#include "io/text_file.hpp"

#include <cmath>
#include <cstdio>

namespace eulastic {
namespace {

std::string quoted(const std::string &text) {
  std::string result = "\"";
  for (const char c : text) {
    char code[8];
    if (c == '"' || c == '\\')
      result += {'\\', c};
    else if (static_cast<unsigned char>(c) < 0x20)
      result.append(code, std::snprintf(code, sizeof code, "\\u%04x", c));
    else
      result += c;
  }
  return result + '"';
}

std::string number(double value) { return std::isfinite(value) ? format_double(value) : "null"; }

}  // namespace

Json &Json::add(const std::string &key, double value) {
  members_.emplace_back(quoted(key), number(value));
  return *this;
}

Json &Json::add(const std::string &key, long value) {
  members_.emplace_back(quoted(key), std::to_string(value));
  return *this;
}

Json &Json::add(const std::string &key, const std::string &value) {
  members_.emplace_back(quoted(key), quoted(value));
  return *this;
}

Json &Json::add(const std::string &key, const std::array<double, 3> &value) {
  members_.emplace_back(quoted(key), "[" + number(value[0]) + ", " + number(value[1]) + ", " + number(value[2]) + "]");
  return *this;
}

Json &Json::add(const std::string &key, const std::vector<Json> &value) {
  std::string list;
  for (const Json &item : value) list += (list.empty() ? "\n    " : ",\n    ") + item.line();
  members_.emplace_back(quoted(key), "[" + list + (list.empty() ? "]" : "\n  ]"));
  return *this;
}

std::string Json::line() const {
  std::string result;
  for (const auto &[key, value] : members_) result += (result.empty() ? "" : ", ") + key + ": " + value;
  return "{" + result + "}";
}

std::string Json::text() const {
  std::string result;
  for (const auto &[key, value] : members_) result += (result.empty() ? "\n  " : ",\n  ") + key + ": " + value;
  return "{" + result + "\n}\n";
}

}  // namespace eulastic
