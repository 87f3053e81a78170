// Just enough JSON to write: an object with its keys in the order they were added.
#pragma once

#include <array>
#include <string>
#include <vector>

namespace eulastic {

class Json {
public:
  Json &add(const std::string &key, double value);  ///< 17 digits; nan and infinities become null
  Json &add(const std::string &key, long value);
  Json &add(const std::string &key, const std::string &value);
  Json &add(const std::string &key, const std::array<double, 3> &value);
  Json &add(const std::string &key, const std::vector<Json> &value);

  /// One member per line, nested objects on one line each.
  std::string text() const;

private:
  Json &add_text(const std::string &key, const std::string &value);

  std::vector<std::string> members_;  ///< "KEY": VALUE, as JSON text
};

}  // namespace eulastic
