// The output directory: made, locked against a second run, and emptied only of files that are ours.
#pragma once

#include "base/petsc.hpp"

#include <string>

namespace eulastic {

class RunDirectory {
public:
  RunDirectory() = default;
  RunDirectory(const RunDirectory &) = delete;
  RunDirectory &operator=(const RunDirectory &) = delete;
  ~RunDirectory();  ///< unlocks

  /// Collective. Makes `path` (parents too) and locks it. `refusal` is empty, or one line on every rank: it is not
  /// a directory, holds files and `overwrite` is false, is in use by another run, or cannot be written. With
  /// `overwrite` the files of an earlier run go (see is_output_file), all others stay.
  PetscErrorCode open(MPI_Comm comm, const std::string &path, bool overwrite, std::string *refusal);
  /// The same for a run that goes on in its own directory: nothing goes but what a crash left half
  /// written, and the summary, which is not true any more.
  PetscErrorCode reopen(MPI_Comm comm, const std::string &path, std::string *refusal);

  const std::string &path() const { return path_; }
  std::string file(const std::string &name) const { return path_ + "/" + name; }

private:
  enum class Old { refused, replaced, continued };
  std::string open_locally(Old old);
  PetscErrorCode open(MPI_Comm comm, const std::string &path, Old old, std::string *refusal);

  std::string path_;
  int lock_ = -1;  ///< rank 0: descriptor of the flock'ed file; the system unlocks it when the process dies
};

/// Names that a run writes into its directory, temporary ones included.
bool is_output_file(const std::string &name);

}  // namespace eulastic
