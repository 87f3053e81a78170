// A position on the grid: its cell, the rank that owns the cell, and the velocity there.
#pragma once

#include "field/field.hpp"
#include "grid/domain.hpp"
#include "grid/linear.hpp"

namespace eulastic {

struct GridPlace {
  Int3 cell{};   ///< global index
  Int3 shift{};  ///< from unwrapped global indices to local ones

  GridPlace(const Domain &domain, const Real3 &place) {
    for (int d = 0; d < domain.dimension(); ++d) {
      const int plain = static_cast<int>(std::floor(place[d] / domain.spacing()[d]));
      cell[d] = domain.is_wall(d) ? std::clamp(plain, 0, domain.domain_cells()[d] - 1) : domain.image(d, plain);
      shift[d] = (domain.is_wall(d) ? 0 : cell[d] - plain) - domain.layout().begin[d];
    }
  }
  int owner(const Domain &domain) const { return domain.owner(cell[0], cell[1], cell[2]); }
  /// Interpolates the velocity linearly between faces, at a position less than a cell away from the one given at
  /// construction. Call it on the rank that owns the cell; two ghost layers of the velocity.
  Real3 velocity(const Domain &domain, const Field &velocity, const Real3 &place) const {
    Real3 sum{};
    for (int a = 0; a < domain.dimension(); ++a) {
      const ConstView v = velocity[a];
      LinearPoints(domain, at_face[a], place.data()).for_all([&](const LinearPoints::Point &point) {
        sum[a] += point.weight * v(point.at[0] + shift[0], point.at[1] + shift[1], point.at[2] + shift[2]);
      });
    }
    return sum;
  }
};

}  // namespace eulastic
