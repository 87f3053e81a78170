// Volumes of voxels and triangulated surfaces, passed from the readers of files (io) to the generation of bodies.
#pragma once

#include "grid/box.hpp"

#include <functional>
#include <string>

namespace eulastic {

/// A regular array of voxels. Voxel (i,j,k) begins at corner + (i,j,k) spacing.
struct VoxelBox {
  Int3 count{};
  Real3 spacing{}, corner{};  ///< units of length
};

/// Reads the solid fractions of the voxels begin <= (i,j,k) < end, x fastest. Returns an error message, empty if there
/// is none. Sequential files require that `begin` never decreases from call to call.
using ReadVoxels = std::function<std::string(const Int3 &begin, const Int3 &end, double *fractions)>;

/// Cells begin <= (i,j,k) < begin + size of a box, such as those of a rank.
struct CellWindow {
  Real3 length{};  ///< edges of the box
  Int3 cells{};    ///< cells of the box
  Int3 begin{}, size{};

  CellWindow(const DomainShape &grid, const Int3 &first, const Int3 &count)
      : length(grid.length), cells(grid.cells), begin(first), size(count) {}
  CellWindow(const Box &box) : CellWindow(box.domain_shape(), box.layout().begin, box.cells()) {}
  double spacing(int d) const { return length[d] / cells[d]; }
};

/// Corners in counter-clockwise order as seen from outside.
using Triangle = std::array<Real3, 3>;

}  // namespace eulastic
