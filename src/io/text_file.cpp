#include "io/text_file.hpp"

#include "io/fail_together.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>
#include <cerrno>
#include <charconv>
#include <cstdio>
#include <cstring>
#include <filesystem>

namespace eulastic {
namespace {

std::string complain(const std::string &path, const char *what) {
  return std::string("cannot ") + what + " " + path + ": " + std::strerror(errno);
}

bool sync_path(const std::string &path, int flags) {
  const int file = ::open(path.c_str(), flags | O_CLOEXEC);
  if (file < 0) return false;
  const bool synced = ::fsync(file) == 0;
  return ::close(file) == 0 && synced;
}

std::string write_locally(const std::string &path, const std::string &text) {
  std::FILE *file = std::fopen(temporary_name(path).c_str(), "we");
  if (!file) return complain(path, "create");
  const bool written = std::fwrite(text.data(), 1, text.size(), file) == text.size();
  return replace_file(path, std::fclose(file) == 0 && written ? "" : complain(path, "write"));
}

}  // namespace

std::string format_double(double value) {
  char text[40];
  return {text, std::to_chars(text, text + sizeof text, value, std::chars_format::general, 17).ptr};
}

std::string temporary_name(const std::string &path) { return path + ".tmp"; }

std::string replace_file(const std::string &path, std::string wrong) {
  const std::string temporary = temporary_name(path), folder = std::filesystem::path(path).parent_path();
  if (wrong.empty() && !sync_path(temporary, O_RDWR)) wrong = complain(path, "sync");
  if (wrong.empty() && std::rename(temporary.c_str(), path.c_str()) != 0) wrong = complain(path, "rename to");
  if (wrong.empty())
    (void)sync_path(folder.empty() ? "." : folder, O_RDONLY | O_DIRECTORY);  // the file is whole without it
  else
    ::unlink(temporary.c_str());
  return wrong;
}

PetscErrorCode write_text_file(MPI_Comm comm, const std::string &path, const std::string &text) {
  int rank;
  PetscFunctionBeginUser;
  PetscCallMPI(MPI_Comm_rank(comm, &rank));
  PetscCall(fail_together(comm, rank == 0 ? write_locally(path, text) : std::string()));
  PetscFunctionReturn(0);
}

void FileStamp::take(const std::string &path) {
  struct stat status {};
  (void)::stat(path.c_str(), &status);
  device_ = status.st_dev;
  file_ = status.st_ino;
  bytes_ = status.st_size;
}

std::string FileStamp::difference(const std::string &path) const {
  struct stat status {};
  if (::stat(path.c_str(), &status) != 0) return path + " was removed by another program during the run";
  if (status.st_dev == device_ && status.st_ino == file_ && status.st_size == bytes_) return {};
  return path + " was changed by another program during the run: it has " + std::to_string(status.st_size) +
         " bytes, this run had written " + std::to_string(bytes_);
}

}  // namespace eulastic
