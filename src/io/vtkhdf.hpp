// snapshot_NNNNNN.vtkhdf, a snapshot as an image of VTK, and snapshots.vtkhdf.series, the list of them with times.
// VTKHDF 1.0: docs.vtk.org, "VTKHDF file format".
#pragma once

#include "base/petsc.hpp"
#include "grid/domain.hpp"
#include "io/snapshot.hpp"

namespace eulastic {

/// Collective. Writes `directory`/`name`.vtkhdf: the grid of cells, and links to the datasets of the `drawn` fields in
/// `name`.h5 in the same directory, (nz,ny,nx) or (nz,ny,nx,3), as fields of cells. Holds no values.
PetscErrorCode write_vtkhdf(const Domain &domain, const std::string &directory, const std::string &name,
                            const std::vector<SnapshotField> &drawn);

/// Collective. Writes the list anew: those of `entries` that have a .vtkhdf file.
PetscErrorCode write_vtkhdf_series(MPI_Comm comm, const std::string &directory,
                                   const std::vector<SnapshotEntry> &entries);

}  // namespace eulastic
