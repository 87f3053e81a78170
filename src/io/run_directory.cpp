#include "io/run_directory.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <regex>
#include <vector>

namespace eulastic {
namespace {

namespace fs = std::filesystem;
constexpr const char *lock_name = ".lock";

// Everything but the lock; false if the directory cannot be read.
bool list(const std::string &path, std::vector<fs::path> *entries) {
  std::error_code error;
  for (fs::directory_iterator it(path, error), end; !error && it != end; it.increment(error))
    if (it->path().filename() != lock_name) entries->push_back(it->path());
  return !error;
}

}  // namespace

bool is_output_file(const std::string &name) {
  static const std::regex ours(
      "(options\\.txt|(series|probes|profile_[xyz])\\.csv|summary\\.json|bodies\\.h5|(snapshots|walls)\\.xdmf|"
      "(snapshot|checkpoint)_[0-9]+\\.h5)"
      "(\\.tmp)?");
  return std::regex_match(name, ours);
}

std::string RunDirectory::open_locally(Old old) {
  const auto because = [&](const std::string &reason) { return "-output_dir " + path_ + ": " + reason; };
  std::error_code error;
  if (fs::exists(path_, error) && !fs::is_directory(path_, error)) return because("is not a directory");
  fs::create_directories(path_, error);
  if (error) return because(error.message());
  std::vector<fs::path> entries;
  if (!list(path_, &entries)) return because("cannot be read");
  if (!entries.empty() && old == Old::refused)
    return because("is not empty (choose another -output_dir, or -output_overwrite to replace the earlier run)");
  lock_ = ::open(file(lock_name).c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
  if (lock_ < 0) return because(std::strerror(errno));
  // Any other failure: a file system without locks, where we do without.
  if (::flock(lock_, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) return because("is in use by another run");
  for (const fs::path &entry : entries)
    if (is_output_file(entry.filename()) &&
        (old == Old::replaced || entry.extension() == ".tmp" || entry.filename() == "summary.json") &&
        !fs::remove(entry, error) && error)
      return because("cannot remove " + entry.filename().string() + " (" + error.message() + ")");
  return {};
}

PetscErrorCode RunDirectory::open(MPI_Comm comm, const std::string &path, bool overwrite, std::string *refusal) {
  PetscFunctionBeginUser;
  PetscCall(open(comm, path, overwrite ? Old::replaced : Old::refused, refusal));
  PetscFunctionReturn(0);
}

PetscErrorCode RunDirectory::reopen(MPI_Comm comm, const std::string &path, std::string *refusal) {
  PetscFunctionBeginUser;
  PetscCall(open(comm, path, Old::continued, refusal));
  PetscFunctionReturn(0);
}

PetscErrorCode RunDirectory::open(MPI_Comm comm, const std::string &path, Old old, std::string *refusal) {
  int rank;
  PetscFunctionBeginUser;
  PetscCallMPI(MPI_Comm_rank(comm, &rank));
  path_ = path;
  if (rank == 0) *refusal = open_locally(old);
  int length = static_cast<int>(refusal->size());
  PetscCallMPI(MPI_Bcast(&length, 1, MPI_INT, 0, comm));
  refusal->resize(length);
  PetscCallMPI(MPI_Bcast(refusal->data(), length, MPI_CHAR, 0, comm));
  PetscFunctionReturn(0);
}

RunDirectory::~RunDirectory() {
  if (lock_ >= 0) (void)::close(lock_);
}

}  // namespace eulastic
