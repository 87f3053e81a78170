// Voxels become cells, conservatively: phi of a cell is the mean of the voxels over it, by the exact overlap of boxes.
#pragma once

#include "grid/voxels.hpp"

namespace eulastic {

/// Sets `fraction` of the cells of `window`, whose first one is (0,0,0) in it; 0 where there are no voxels. The volume
/// is kept to round-off, except for what lies outside the box. Collective over all ranks of the program, each with its
/// window: `read` is called alike on all, for the box of voxels that overlap cells of any, at most 2^18 at a time. The
/// same bits on any ranks. Returns what is wrong with the voxels, or nothing.
std::string resample(const CellWindow &window, const VoxelBox &box, const ReadVoxels &read, View fraction);

/// Round-off next to 0 and 1 removed: a cell that is full is exactly full.
double clean_fraction(double phi) noexcept;

}  // namespace eulastic
