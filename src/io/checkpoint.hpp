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

/// Reads one. All members are collective and fail alike on all ranks, with one line that begins with the path.
class CheckpointFile : public Hdf5File {
public:
  /// Refuses files that are no checkpoints, formats of other versions, and files of which a dataset or a checksum is
  /// missing or has changed.
  PetscErrorCode open(MPI_Comm comm, const std::string &path);
  /// The program that wrote it.
  const std::string &version() const { return version_; }
  PetscErrorCode read_options(std::string *options);
  /// The names in `numbers` say what to read.
  PetscErrorCode read_numbers(CheckpointNumbers *numbers);
  /// Each rank gets an equal share; none if there are none.
  PetscErrorCode read_records(CheckpointRecords *records);
  /// Owned points, the high wall included.
  PetscErrorCode read_fields(const Box &box, const std::vector<CheckpointField> &fields);

private:
  std::string version_;
};

}  // namespace eulastic
