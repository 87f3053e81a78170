// Positions relative to a reference cell that follows a body; they are continuous across periodic boundaries.
#pragma once

#include "grid/box.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace eulastic {

/// Returns the global cell that contains a position in the domain.
inline Int3 cell_of(const Box &box, const Real3 &position) {
  Int3 cell{};
  for (int d = 0; d < box.dimension(); ++d)
    cell[d] = std::clamp(static_cast<int>(std::floor(position[d] / box.spacing()[d])), 0, box.domain_cells()[d] - 1);
  return cell;
}

/// Returns the references wrapped into the domain along periodic directions, as offset() needs them.
inline std::vector<Int3> within_box(const Box &box, std::vector<Int3> references) {
  for (Int3 &cell : references)
    for (int d = 0; d < box.dimension(); ++d) cell[d] = box.image(d, cell[d]);
  return references;
}

/// Returns the number of cells along d from `reference`, wrapped, to the nearest image of local index i.
inline int offset(const Box &box, int d, int reference, int i) {
  const int n = box.domain_cells()[d], half = n / 2, distance = box.layout().begin[d] + i - reference;
  return box.is_wall(d) ? distance : distance + (distance < -half ? n : distance >= n - half ? -n : 0);
}

/// Returns the same offset in all directions for a cell.
inline Real3 offset(const Box &box, const Int3 &reference, const Int3 &cell) {
  Real3 x{};
  for (int d = 0; d < box.dimension(); ++d) x[d] = offset(box, d, reference[d], cell[d]);
  return x;
}

}  // namespace eulastic
