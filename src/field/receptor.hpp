// A receptor: a material point on the surface of a body in a box, which can hold one bond (docs/method.md, section 21).
#pragma once

#include "grid/box.hpp"

namespace eulastic {

struct Receptor {
  static constexpr double none = -1, wall = 0;
  Real3 place{};          ///< not wrapped around periodic sides
  double partner = none;  ///< number of the body that it is bound to; `wall`: a wall or a surface on the grid
  double other = 0;       ///< index of the receptor of that body
  double pair = 0;        ///< of AdhesionSpec::pairs, while bound
  Real3 anchor{};         ///< the other end of the bond, not wrapped around periodic sides
  double since = 0;       ///< time of formation

  bool is_bound() const { return partner != none; }

  static constexpr int numbers = 10;
  /// All of it, exactly.
  std::array<double, numbers> packed() const {
    return {place[0], place[1], place[2], partner, other, pair, anchor[0], anchor[1], anchor[2], since};
  }
  static Receptor unpacked(const double *v) { return {{v[0], v[1], v[2]}, v[3], v[4], v[5], {v[6], v[7], v[8]}, v[9]}; }
};

}  // namespace eulastic
