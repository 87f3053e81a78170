// The pairs of surfaces that adhere, and their parameters.
#pragma once

#include "bodies/solid_mask.hpp"
#include "grid/box.hpp"
#include "kernels/bond.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

namespace eulastic {

/// The part of the domain in which walls and surfaces are adhesive.
struct AdhesiveRegion {
  Real3 low{-HUGE_VAL, -HUGE_VAL, -HUGE_VAL}, high{HUGE_VAL, HUGE_VAL, HUGE_VAL};  ///< corners of a box
  VoxelSpec file;                                                                  ///< cells; without a path: all cells
  std::shared_ptr<const SolidMask> cells;  ///< the cells that the file fills at least in part, once it has been read

  bool is_given() const { return low[0] != -HUGE_VAL || !file.path.empty(); }
  /// Returns whether a position, which need not be wrapped into the domain, is in the box and in one of the cells.
  bool has(const Box &domain, const Real3 &place) const {
    Int3 cell{};
    for (int d = 0; d < domain.dimension(); ++d) {
      const double length = domain.domain_shape().length[d];
      const double wrapped = domain.is_wall(d) ? place[d] : place[d] - length * std::floor(place[d] / length);
      if (!(wrapped >= low[d] && wrapped <= high[d])) return false;
      cell[d] = std::clamp(static_cast<int>(wrapped / domain.spacing()[d]), 0, domain.domain_cells()[d] - 1);
    }
    return !cells || cells->has(cell);
  }
};

struct AdhesionPair {
  static constexpr int wall = -1;
  std::string name;           ///< NAME1-NAME2, or NAME-wall
  int first = 0, second = 0;  ///< species; the second may be on the grid, or be `wall`
  kernels::BondLaw law;
  double density = 0;  ///< receptors per area (2-D: per length) on both species
  AdhesiveRegion region;

  bool to_wall() const { return second == wall; }
  bool joins(int one, int two) const { return (first == one && second == two) || (first == two && second == one); }
  bool has(int species) const { return species == first || species == second; }
};

struct AdhesionSpec {
  std::vector<AdhesionPair> pairs;
  long seed = 0;
};

}  // namespace eulastic
