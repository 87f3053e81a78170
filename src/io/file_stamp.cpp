#include "io/file_stamp.hpp"

#include <sys/stat.h>

namespace eulastic {

void FileStamp::take(const std::string &path) {
  struct stat status {};
  (void)::stat(path.c_str(), &status);
  device_ = status.st_dev;
  file_ = status.st_ino;
  bytes_ = status.st_size;
}

std::string FileStamp::difference(const std::string &path) const {
  struct stat status {};
  if (::stat(path.c_str(), &status) != 0) return path + " has vanished while the run went on";
  if (status.st_dev == device_ && status.st_ino == file_ && status.st_size == bytes_) return {};
  return path + " was changed by another program while the run went on: " + std::to_string(status.st_size) +
         " bytes where this one had written " + std::to_string(bytes_);
}

}  // namespace eulastic
