// A file as this process has left it, so that it notices if somebody else removes, replaces, cuts or extends the file.
#pragma once

#include <sys/types.h>

#include <string>

namespace eulastic {

class FileStamp {
public:
  /// Notes which file `path` is, and how long.
  void take(const std::string &path);
  /// Empty if `path` is the same file and as long as it was when take() was called; else one line.
  std::string difference(const std::string &path) const;

private:
  dev_t device_ = 0;
  ino_t file_ = 0;
  off_t bytes_ = 0;
};

}  // namespace eulastic
