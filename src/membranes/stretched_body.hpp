// -NAME_stretch_force of a body that is alone in its box; of the labelled bodies of a grid:
// membranes/stretch_force.hpp.
#pragma once

#include "base/exact_sum.hpp"
#include "field/phase.hpp"

namespace eulastic {

inline bool is_stretched(const Material &material) { return material.stretch_force.force > 0; }

class StretchedBody {
public:
  /// Finds the ends of the body. What is given must outlive this.
  StretchedBody(const Box &box, const Phase &phase);
  /// force += the force per volume along x on the faces of the box.
  void add_force(View force) const;
  /// Adds to sum `which` what it does on a flow with this velocity along x, over the volume of a cell.
  void add_power(ConstView velocity, int which, ExactSums *sum) const;

private:
  const Box *box_;
  const Phase *phase_;
  std::vector<double> per_volume_;  ///< of the columns of the box
};

}  // namespace eulastic
