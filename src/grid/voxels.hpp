// Volumes of voxels and triangulated surfaces as they come from files: what io hands to bodies.
#pragma once

#include "grid/box.hpp"

#include <functional>
#include <string>

namespace eulastic {

/// Equal boxes in a row, a plane or a volume. Voxel (i,j,k) begins at corner + (i,j,k) spacing.
struct VoxelBox {
  Int3 count{};
  Real3 spacing{}, corner{};  ///< length
};

/// Solid fractions of the voxels begin <= (i,j,k) < end, x fastest. Returns what is wrong, or nothing. Files that are
/// read from the front need calls that begin ever further on.
using ReadVoxels = std::function<std::string(const Int3 &begin, const Int3 &end, double *fractions)>;

/// Cells begin <= (i,j,k) < begin + size of a box: those of a rank, or any others.
struct CellWindow {
  Real3 length{};  ///< of the box
  Int3 cells{};    ///< of the box
  Int3 begin{}, size{};

  CellWindow(const DomainShape &grid, const Int3 &first, const Int3 &count)
      : length(grid.length), cells(grid.cells), begin(first), size(count) {}
  CellWindow(const Box &box) : CellWindow(box.domain_shape(), box.layout().begin, box.cells()) {}
  double spacing(int d) const { return length[d] / cells[d]; }
};

/// Corners in counter-clockwise order seen from outside.
using Triangle = std::array<Real3, 3>;

}  // namespace eulastic
