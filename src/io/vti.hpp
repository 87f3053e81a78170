// snapshot_NNNNNN.vti, a snapshot as plain image data of VTK (XML with raw values appended, which every version reads),
// and snapshots.pvd, the list of them with times. File format: "VTK File Formats", www.vtk.org.
#pragma once

#include "base/petsc.hpp"
#include "grid/domain.hpp"
#include "io/snapshot.hpp"

namespace eulastic {

/// Collective. Writes `directory`/`name`.vti from `name`.h5 beside it: the grid of cells, and as arrays of cells the
/// `drawn` fields, (nz,ny,nx) or (nz,ny,nx,3). The array wall_shear_stress is that on vessels and obstacles, if it is
/// drawn, and in the cells beside the walls of the box that of `walls`, of several the largest.
PetscErrorCode write_vti(const Domain &domain, const std::string &directory, const std::string &name, double time,
                         const std::vector<SnapshotField> &drawn, const std::vector<SnapshotField> &walls);

/// Collective. Writes the list anew: those of `entries` that have a .vti file.
PetscErrorCode write_pvd(MPI_Comm comm, const std::string &directory, const std::vector<SnapshotEntry> &entries);

}  // namespace eulastic
