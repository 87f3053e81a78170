// Linear interpolation of a field at a position.
#pragma once

#include "grid/box.hpp"

#include <cmath>

namespace eulastic {

/// The points of a staggered field around a position, 4 in 2-D and 8 in 3-D, and their weights.
class LinearPoints {
public:
  struct Point {
    Int3 at;  ///< unwrapped global index
    double weight;
    Real3 slope;  ///< derivatives of the weight with respect to the position
  };

  LinearPoints(const Box &box, const Staggering &staggering, const double place[3])
      : dimension_(box.dimension()), spacing_(box.spacing()) {
    for (int d = 0; d < dimension_; ++d) {
      const double at = place[d] / spacing_[d] - (staggering[d] ? 0 : 0.5), low = std::floor(at);
      first_[d] = static_cast<int>(low);
      part_[d] = at - low;
    }
  }
  /// Restricts the points along d to low ... high; the interpolation is constant beyond them.
  void keep_between(int d, int low, int high) {
    const double at = std::clamp(first_[d] + part_[d], double(low), double(high));
    first_[d] = std::min(static_cast<int>(std::floor(at)), high - 1);
    part_[d] = at - first_[d];
  }
  /// Calls visit(point) for all points.
  template <class Visit>
  void for_all(const Visit &visit) const {
    for (int corner = 0; corner < (dimension_ == 3 ? 8 : 4); ++corner) {
      Point point{first_, 1, {}};
      Real3 along{};
      for (int d = 0; d < dimension_; ++d) {
        const int step = corner >> d & 1;
        point.at[d] += step;
        along[d] = step ? part_[d] : 1 - part_[d];
        point.weight *= along[d];
        point.slope[d] = (step ? 1 : -1) / spacing_[d];
      }
      for (int d = 0; d < dimension_; ++d)
        for (int e = 0; e < dimension_; ++e)
          if (e != d) point.slope[d] *= along[e];
      visit(point);
    }
  }

private:
  int dimension_;
  Real3 spacing_;
  Int3 first_{};
  Real3 part_{};
};

}  // namespace eulastic
