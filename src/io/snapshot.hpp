// snapshot_NNNNNN.h5, a picture of the fields at one time, and snapshots.xdmf, which shows them all to ParaView; on
// request the same as VTK's XML image data.
#pragma once

#include "base/petsc.hpp"
#include "grid/domain.hpp"
#include "io/hdf5_file.hpp"

namespace eulastic {

struct SnapshotField {
  FieldFormat format;                 ///< dataset name, place, precision
  std::vector<ConstView> components;  ///< one, or three for a vector
};

/// One snapshot of the index: name of its file without extension, its time, and its grid in XDMF.
struct SnapshotEntry {
  std::string name;
  double time;
  std::string grid;
};

/// Numbers snapshots from 0 and remembers them for the index.
class SnapshotWriter {
public:
  /// `vti`: also writes each snapshot as a file of VTK's XML image data.
  SnapshotWriter(const Domain &domain, std::string directory, bool vti)
      : domain_(&domain), directory_(std::move(directory)), vti_(vti) {}

  /// Before the first write(): continues after `count` snapshots. Where they are in this directory, the index continues
  /// too, and later ones are removed.
  PetscErrorCode resume(int count, bool same_directory);
  void moved_to(const std::string &directory) { directory_ = directory; }
  int count() const { return count_; }
  /// Collective. Writes one file with its attributes, then the indices anew.
  PetscErrorCode write(double time, long step, const std::vector<SnapshotField> &fields);

private:
  const Domain *domain_;
  std::string directory_;
  bool vti_;
  int count_ = 0;
  std::vector<SnapshotEntry> index_;  ///< on rank 0
};

}  // namespace eulastic
