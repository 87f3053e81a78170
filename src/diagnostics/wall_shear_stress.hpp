// The tangential traction of fluid and attached bodies on the walls: mu du/dn + elastic stress, n into the box.
//
// du/dn is one-sided and second order, from the wall's velocity and two points; averaged to the centres of the wall's
// cells.
#pragma once

#include "field/phase.hpp"
#include "field/sides.hpp"
#include "flow/local_viscosity.hpp"
#include "grid/box.hpp"

namespace eulastic {

/// One wall. Components x, y, z (0 along the normal) of its cells on this rank, x fastest; nothing on ranks that do
/// not touch it.
struct WallStress {
  int direction = 0;
  bool high = false;
  std::array<std::vector<double>, 3> components;
  std::ptrdiff_t sy = 0, sz = 0;
  ConstView view(int c) const { return {components[c].data(), sy, sz}; }
};

/// All walls of the box. One ghost layer of velocity (at `time`) and B must be valid.
std::vector<WallStress> wall_shear_stress(const Box &box, const BoxSides &sides, double time,
                                          const EdgeViscosity &viscosity, const Field &velocity,
                                          const std::vector<Phase> &phases);

}  // namespace eulastic
