#include "io/run_directory.hpp"

#include "io/fail_together.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>
#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <regex>
#include <vector>

namespace eulastic {
namespace {

namespace fs = std::filesystem;
constexpr const char *lock_name = ".lock", *new_name = ".new";

// Everything but what is this file's own; false if the directory cannot be read.
bool list(const std::string &path, std::vector<fs::path> *entries) {
  std::error_code error;
  for (fs::directory_iterator it(path, error), end; !error && it != end; it.increment(error))
    if (it->path().filename() != lock_name && it->path().filename() != new_name) entries->push_back(it->path());
  return !error;
}

}  // namespace

bool is_output_file(const std::string &name) {
  static const std::regex ours(
      "(options\\.txt|(series|probes|profile_[xyz])\\.csv|summary\\.json|bodies\\.h5|(snapshots|walls)\\.xdmf|"
      "snapshots\\.(vtkhdf\\.series|pvd)|snapshot_[0-9]+\\.(vtkhdf|vti)|(snapshot|checkpoint)_[0-9]+\\.h5)"
      "(\\.tmp)?");
  return std::regex_match(name, ours);
}

std::string RunDirectory::open_locally() {
  const auto because = [&](const std::string &reason) { return "-output_dir " + path_ + ": " + reason; };
  std::error_code error;
  if (fs::exists(path_, error) && !fs::is_directory(path_, error))
    return because("is not a directory; accepted: a directory, or a path where one can be created");
  fs::create_directories(path_, error);
  if (error) return because(error.message());
  std::vector<fs::path> entries;
  if (!list(path_, &entries)) return because("cannot be read");
  if (!entries.empty() && earlier_ == Earlier::refused)
    return because(
        "is not empty (choose another -output_dir, or -output_overwrite on the command line to replace the earlier "
        "run)");
  lock_ = ::open((path_ + "/" + lock_name).c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
  if (lock_ < 0) return because(std::strerror(errno));
  // Any other failure: a file system without locks, where we do without.
  if (::flock(lock_, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) return because("is in use by another run");
  pending_ =
      std::any_of(entries.begin(), entries.end(), [](const fs::path &p) { return is_output_file(p.filename()); });
  fs::remove_all(path_ + "/" + new_name, error);  // of a run that was killed before it was accepted
  if (!error && path() != path_) fs::create_directory(path(), error);
  return error ? because("cannot be written (" + error.message() + ")") : "";
}

std::string RunDirectory::accept_locally() const {
  const bool replaced = earlier_ == Earlier::replaced;
  std::vector<fs::path> old, made;
  std::error_code error;
  if (!list(path_, &old) || (replaced && !list(path(), &made))) return "-output_dir " + path_ + ": cannot be read";
  for (const fs::path &entry : made) {
    fs::rename(entry, path_ / entry.filename(), error);
    if (error) return path_ + ": cannot move " + entry.filename().string() + " to it (" + error.message() + ")";
  }
  for (const fs::path &entry : old) {
    const auto same = [&](const fs::path &other) { return other.filename() == entry.filename(); };
    if (!is_output_file(entry.filename()) || std::any_of(made.begin(), made.end(), same)) continue;
    if (replaced || entry.extension() == ".tmp" || entry.filename() == "summary.json") fs::remove(entry, error);
    if (error) return path_ + ": cannot remove " + entry.filename().string() + " (" + error.message() + ")";
  }
  if (replaced) fs::remove(path(), error);
  return {};
}

PetscErrorCode RunDirectory::open(MPI_Comm comm, const std::string &path, Earlier earlier, std::string *refusal) {
  int rank;
  PetscFunctionBeginUser;
  PetscCallMPI(MPI_Comm_rank(comm, &rank));
  path_ = path;
  earlier_ = earlier;
  if (rank == 0) *refusal = open_locally();
  int known[2] = {static_cast<int>(refusal->size()), pending_};
  PetscCallMPI(MPI_Bcast(known, 2, MPI_INT, 0, comm));
  refusal->resize(known[0]);
  pending_ = known[1] != 0;
  PetscCallMPI(MPI_Bcast(refusal->data(), known[0], MPI_CHAR, 0, comm));
  PetscFunctionReturn(0);
}

PetscErrorCode RunDirectory::accept(MPI_Comm comm) {
  PetscFunctionBeginUser;
  if (!pending_) PetscFunctionReturn(0);
  PetscCall(fail_together(comm, lock_ >= 0 ? accept_locally() : std::string()));
  pending_ = false;
  PetscFunctionReturn(0);
}

RunDirectory::~RunDirectory() {
  if (lock_ < 0) return;
  std::error_code error;
  if (path() != path_) fs::remove_all(path(), error);
  (void)::close(lock_);
}

}  // namespace eulastic
