// -NAME_stretch_force for a body in a box of its own; membranes/stretch_force.hpp treats labelled bodies on the grid.
#pragma once

#include "base/exact_sum.hpp"
#include "field/phase.hpp"

namespace eulastic {

inline bool is_stretched(const Material &material) { return material.stretch_force.force > 0; }

class StretchedBody {
public:
  /// Finds the ends of the body. `box` and `phase` must outlive this.
  StretchedBody(const Box &box, const Phase &phase);
  /// Adds the force per volume along x on the faces of the box.
  void add_force(View force) const;
  /// Adds the power of the force on a flow with this velocity along x, divided by the cell volume, to sum `which`.
  void add_power(ConstView velocity, int which, ExactSums *sum) const;

private:
  const Box *box_;
  const Phase *phase_;
  std::vector<double> per_volume_;  ///< force per volume, by column of the box
};

}  // namespace eulastic
