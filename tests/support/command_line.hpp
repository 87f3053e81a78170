// A valid scene as a command line, and files for one test.
#pragma once

#include "options/parse_options.hpp"

#include <gtest/gtest.h>

#include <cstdio>
#include <fstream>
#include <sstream>

#include <unistd.h>

namespace eulastic {

using Words = std::vector<std::string>;

inline Words words(const std::string &line) {
  std::istringstream stream(line);
  Words list;
  for (std::string word; stream >> word;) list.push_back(word);
  return list;
}

inline ParseResult parse_line(const std::string &line, const std::string &environment = {}) {
  return parse(words(line), environment);
}

// A valid scene to spoil.
inline const std::string scene =
    "-grid_cells 16,16,16 -grid_length 8,8,8 -boundary_y wall -time_end 2 -species cell -cell_shape sphere "
    "-cell_radius 2 -cell_shear_modulus 0.5";

// A file of this process that goes with the test.
class TemporaryFile {
public:
  explicit TemporaryFile(const std::string &text)
      : path_(testing::TempDir() + "options_test_" + std::to_string(getpid()) + "_" + std::to_string(++count_)) {
    std::ofstream(path_) << text;
  }
  ~TemporaryFile() { std::remove(path_.c_str()); }
  const std::string &path() const { return path_; }

private:
  static inline int count_ = 0;
  std::string path_;
};

}  // namespace eulastic
