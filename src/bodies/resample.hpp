// Conservative resampling of voxels: phi of a cell is the mean of the voxels that cover it, weighted by the exact
// overlap of the boxes.
#pragma once

#include "grid/voxels.hpp"

namespace eulastic {

/// Sets `fraction` in the cells of `window` (indices relative to its first cell); it is 0 where there are no voxels.
/// The volume inside the domain is conserved to round-off. Collective over all ranks of the program, each with its own
/// window: all ranks call `read` with the same arguments, at most 2^18 voxels at a time, for the box of voxels that
/// overlap any rank's cells. The bits do not depend on the ranks. Returns an empty string, or an error in the voxels.
std::string resample(const CellWindow &window, const VoxelBox &box, const ReadVoxels &read, View fraction);

/// Rounds fractions within 1e-12 of 0 and 1, so that a full cell is exactly full.
double clean_fraction(double phi) noexcept;

}  // namespace eulastic
