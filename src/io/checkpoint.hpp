// checkpoint_NNNNNNNN.h5: everything a run needs to go on, as named fields, numbers and the options it had.
#pragma once

#include "base/petsc.hpp"
#include "grid/domain.hpp"
#include "io/hdf5_file.hpp"

#include <map>

namespace eulastic {

struct CheckpointField {
  std::string name;
  Staggering staggering;
  View view;
  Stored stored = Stored::float64;
  bool optional = false;  ///< may be missing in the file; the view is then left alone
};

/// Numbers by name; dataset names are those names.
struct CheckpointNumbers {
  std::map<std::string, std::vector<double>> reals;
  std::map<std::string, std::vector<long>> integers;
};

/// Records that ranks have some of each; nothing is written of none at all.
struct CheckpointRecords {
  std::string name;
  std::size_t numbers;  ///< of each
  std::vector<double> values;
};

/// Checkpoints are numbered by their step.
std::string checkpoint_name(long step);
/// Local. Paths of the checkpoints in a directory, newest first.
std::vector<std::string> list_checkpoints(const std::string &directory);
/// Step in a checkpoint's file name, -1 for other names.
long checkpoint_step(const std::string &path);

/// Collective. Fields with the high wall where they are staggered towards one.
PetscErrorCode write_checkpoint(const Domain &domain, const std::string &path, const std::string &options,
                                const CheckpointNumbers &numbers, const std::vector<CheckpointField> &fields,
                                const std::vector<CheckpointRecords> &records);

/// Reads one. Every dataset must have its checksum and match it. All members are collective and fail alike on all
/// ranks, with one line that begins with the path.
class CheckpointFile {
public:
  /// Refuses what is not a checkpoint, formats of other versions, and files whose datasets or checksums have changed.
  PetscErrorCode open(MPI_Comm comm, const std::string &path);
  /// The program that wrote it.
  const std::string &version() const { return version_; }
  PetscErrorCode read_options(std::string *options);
  /// The names in `numbers` say what to read.
  PetscErrorCode read_numbers(CheckpointNumbers *numbers);
  /// Integers that not every checkpoint has: empty if this one has not.
  PetscErrorCode read_if_there(const std::string &name, std::vector<long> *integers);
  bool has(const std::string &name) const { return file_.has(name); }
  /// Each rank gets some; none if there are none.
  PetscErrorCode read_records(CheckpointRecords *records);
  /// As many as `values` has room for, one rank's after the other's: all of them together.
  PetscErrorCode read_own_records(CheckpointRecords *records);
  /// As Hdf5File::read_share().
  template <class T>
  PetscErrorCode read_share(const std::string &name, hsize_t total, hsize_t begin, std::vector<T> *values) {
    PetscFunctionBeginUser;
    PetscCall(require_checksum(name));
    PetscCall(file_.read_share(name, total, begin, values));
    PetscFunctionReturn(0);
  }
  /// Owned points, the high wall included.
  PetscErrorCode read_fields(const Box &box, const std::vector<CheckpointField> &fields);

private:
  PetscErrorCode require_checksum(const std::string &dataset);
  template <class T>
  PetscErrorCode read(const std::string &name, std::vector<T> *values);

  Hdf5File file_;
  std::string version_;
};

}  // namespace eulastic
