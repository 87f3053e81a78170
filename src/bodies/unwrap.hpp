// Places around a body from a reference cell that follows it: continuous across periodic sides.
#pragma once

#include "grid/grid.hpp"

#include <vector>

namespace eulastic {

/// References, those along periodic directions within the box: what offset() starts from.
inline std::vector<Int3> within_box(const Grid &grid, std::vector<Int3> references) {
  for (Int3 &cell : references)
    for (int d = 0; d < grid.dimension(); ++d) cell[d] = grid.image(d, cell[d]);
  return references;
}

/// Cells from a reference within the box to the nearest image of a local cell.
inline Real3 offset(const Grid &grid, const Int3 &reference, const Int3 &cell) {
  Real3 x{};
  for (int d = 0; d < grid.dimension(); ++d) {
    const int n = grid.cells()[d], half = n / 2;
    int distance = grid.layout().begin[d] + cell[d] - reference[d];
    if (!grid.is_wall(d)) distance += distance < -half ? n : distance >= n - half ? -n : 0;
    x[d] = distance;
  }
  return x;
}

}  // namespace eulastic
