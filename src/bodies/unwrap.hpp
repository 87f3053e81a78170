// Places around a body from a reference cell that follows it: continuous across periodic sides.
#pragma once

#include "grid/box.hpp"

#include <vector>

namespace eulastic {

/// References, those along periodic directions within the box: what offset() starts from.
inline std::vector<Int3> within_box(const Box &box, std::vector<Int3> references) {
  for (Int3 &cell : references)
    for (int d = 0; d < box.dimension(); ++d) cell[d] = box.image(d, cell[d]);
  return references;
}

/// Cells along d from `reference`, within the box, to the nearest image of local index i.
inline int offset(const Box &box, int d, int reference, int i) {
  const int n = box.domain_cells()[d], half = n / 2, distance = box.layout().begin[d] + i - reference;
  return box.is_wall(d) ? distance : distance + (distance < -half ? n : distance >= n - half ? -n : 0);
}

/// The same of a cell.
inline Real3 offset(const Box &box, const Int3 &reference, const Int3 &cell) {
  Real3 x{};
  for (int d = 0; d < box.dimension(); ++d) x[d] = offset(box, d, reference[d], cell[d]);
  return x;
}

}  // namespace eulastic
