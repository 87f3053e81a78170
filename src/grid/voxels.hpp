// Volumes of voxels and triangulated surfaces as they come from files: what io hands to bodies.
#pragma once

#include "grid/grid.hpp"

#include <functional>

namespace eulastic {

/// Equal boxes in a row, a plane or a volume. Voxel (i,j,k) begins at corner + (i,j,k) spacing.
struct VoxelBox {
  Int3 count{};
  Real3 spacing{}, corner{};  ///< length
};

/// Solid fractions of the voxels begin <= (i,j,k) < end, x fastest. Returns what is wrong, or nothing. Files that are
/// read from the front need calls that begin ever further on.
using ReadVoxels = std::function<std::string(const Int3 &begin, const Int3 &end, double *fractions)>;

/// Corners in counter-clockwise order seen from outside.
using Triangle = std::array<Real3, 3>;

}  // namespace eulastic
