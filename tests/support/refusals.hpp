// Command lines that are refused, and what the one line of the answer says.
#pragma once

#include "support/command_line.hpp"

namespace eulastic::test {

struct Refusal {
  std::string added;              ///< to the valid scene
  std::vector<std::string> says;  ///< pieces of the message
};

inline void expect_refusals(const std::vector<Refusal> &refusals, const std::string &base = scene) {
  for (const Refusal &refusal : refusals) {
    const ParseResult result = parse_line(base + " " + refusal.added);
    EXPECT_FALSE(result.error.empty()) << refusal.added;
    EXPECT_EQ(result.error.find('\n'), std::string::npos);
    for (const std::string &piece : refusal.says)
      EXPECT_NE(result.error.find(piece), std::string::npos) << refusal.added << " says: " << result.error;
  }
}

}  // namespace eulastic::test
