// The output directory: made, locked against a second run, and emptied only of files that are ours, and only once the
// new run has been accepted.
#pragma once

#include "base/petsc.hpp"

#include <string>

namespace eulastic {

class RunDirectory {
public:
  RunDirectory() = default;
  RunDirectory(const RunDirectory &) = delete;
  RunDirectory &operator=(const RunDirectory &) = delete;
  ~RunDirectory();  ///< unlocks; files of a run that was not accepted go

  /// Treatment of the files of an earlier run (see is_output_file); other files are kept.
  enum class Earlier { refused, replaced, continued };
  /// Collective. Makes `path` (parents too) and locks it. `refusal` is empty, or one line on every rank: it is not
  /// a directory, holds files and `earlier` is refused, is in use by another run, or cannot be written. Nothing that
  /// is there is touched.
  PetscErrorCode open(MPI_Comm comm, const std::string &path, Earlier earlier, std::string *refusal);
  /// Whether an earlier run's files stand there and accept() has not been called.
  bool pending() const { return pending_; }
  /// Collective. Files of an earlier run give way to those written since. A run that goes on loses nothing but what
  /// a crash left half written, and the summary, which is not true any more.
  PetscErrorCode accept(MPI_Comm comm);

  /// The directory to which the run writes; until it is accepted, a subdirectory if it replaces an earlier run.
  std::string path() const { return pending_ && earlier_ == Earlier::replaced ? path_ + "/.new" : path_; }
  std::string file(const std::string &name) const { return path() + "/" + name; }

private:
  std::string open_locally();
  std::string accept_locally() const;

  std::string path_;
  Earlier earlier_ = Earlier::refused;
  bool pending_ = false;
  int lock_ = -1;  ///< rank 0: descriptor of the flock'ed file; the system unlocks it when the process dies
};

/// Names that a run writes into its directory, temporary ones included.
bool is_output_file(const std::string &name);

}  // namespace eulastic
