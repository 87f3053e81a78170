#include "adhesion/surface_feet.hpp"

#include "adhesion/grid_place.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace eulastic {
namespace {

bool is_cut(double phi) { return phi > 1e-3 && phi < 1 - 1e-3; }

// Finds the vector from a cell's centre to the point of the plane in it that is nearest to `from`, clamped to the cell;
// `from` is relative to the centre. Returns false if the cell is not cut.
bool nearest_in_cell(const Box &box, ConstView phi, const Int3 &cell, const Real3 &from, Real3 *nearest) {
  const double here = phi(cell[0], cell[1], cell[2]);
  if (!is_cut(here)) return false;
  const Real3 &h = box.spacing();
  Real3 normal{};
  double squares = 0;
  for (int d = 0; d < box.dimension(); ++d) {
    const std::ptrdiff_t step = phi.stride(d);
    const double *at = &phi(cell[0], cell[1], cell[2]);
    normal[d] = (at[step] - at[-step]) / (2 * h[d]);
    squares += normal[d] * normal[d];
  }
  const double steepness = std::sqrt(squares);
  if (!(steepness > 0)) return false;
  double height = (0.5 - here) / steepness, away = -height;  // of the plane above the centre, of `from` above the plane
  for (int d = 0; d < box.dimension(); ++d) away += from[d] * normal[d] / steepness;
  for (int d = 0; d < box.dimension(); ++d)
    (*nearest)[d] = std::clamp(from[d] - away * normal[d] / steepness, -0.5 * h[d], 0.5 * h[d]);
  return true;
}

}  // namespace

Foot find_foot(const Domain &domain, const Phase &phase, const Real3 &place) {
  const int deep = domain.dimension() == 3 ? foot_reach : 0;
  const Real3 &h = domain.spacing();
  const Int3 shift = GridPlace(domain, place).shift;
  const ConstView phi = phase.fraction[0];
  Int3 plain{};
  for (int d = 0; d < domain.dimension(); ++d) plain[d] = static_cast<int>(std::floor(place[d] / h[d]));
  double least = HUGE_VAL;
  Foot foot;
  for (int z = -deep; z <= deep; ++z)
    for (int y = -foot_reach; y <= foot_reach; ++y)
      for (int x = -foot_reach; x <= foot_reach; ++x) {
        const Int3 step{x, y, z};
        Int3 local{};
        Real3 from{}, nearest{};
        for (int d = 0; d < domain.dimension(); ++d) {
          local[d] = plain[d] + step[d] + shift[d];
          from[d] = place[d] - (plain[d] + step[d] + 0.5) * h[d];
        }
        if (!nearest_in_cell(domain, phi, local, from, &nearest)) continue;
        double distance = 0;
        for (int d = 0; d < domain.dimension(); ++d) distance += std::pow(nearest[d] - from[d], 2);
        if (distance >= least) continue;
        least = distance;
        foot.found = true;
        for (int d = 0; d < domain.dimension(); ++d) foot.place[d] = place[d] + (nearest[d] - from[d]);
      }
  return foot;
}

bool has_surface_in(const Domain &domain, const Phase &phase, const Extent &block) {
  const ConstView phi = phase.fraction[0];
  std::vector<int> local[3];
  for (int d = 0; d < 3; ++d)
    for (int i = block.begin[d]; i < std::min(block.end[d], block.begin[d] + domain.domain_cells()[d]); ++i) {
      const int at = domain.image(d, i) - domain.layout().begin[d];
      if (at >= 0 && at < domain.cells()[d]) local[d].push_back(at);
    }
  for (const int k : local[2])
    for (const int j : local[1])
      for (const int i : local[0])
        if (is_cut(phi(i, j, k))) return true;
  return false;
}

}  // namespace eulastic
