#include "io/json.hpp"

#include "io/option_values.hpp"
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

Json &Json::add_text(const std::string &key, const std::string &value) {
  members_.push_back(quoted(key) + ": " + value);
  return *this;
}

Json &Json::add(const std::string &key, double value) { return add_text(key, number(value)); }

Json &Json::add(const std::string &key, long value) { return add_text(key, std::to_string(value)); }

Json &Json::add(const std::string &key, const std::string &value) { return add_text(key, quoted(value)); }

Json &Json::add(const std::string &key, const std::array<double, 3> &value) {
  return add_text(key, "[" + number(value[0]) + ", " + number(value[1]) + ", " + number(value[2]) + "]");
}

Json &Json::add(const std::string &key, const std::vector<Json> &value) {
  std::vector<std::string> items;
  for (const Json &item : value) items.push_back("{" + join(item.members_, ", ") + "}");
  return add_text(key, items.empty() ? "[]" : "[\n    " + join(items, ",\n    ") + "\n  ]");
}

std::string Json::text() const { return "{\n  " + join(members_, ",\n  ") + "\n}\n"; }

}  // namespace eulastic
