// Tangential traction of fluid and anchored bodies on the walls: mu du/dn + elastic stress, with n into the box.
//
// du/dn is the difference between the velocity of the wall and that of the first point, half a cell away, as in the
// momentum equation, averaged to the centres of the wall's cells.
#pragma once

#include "field/boundaries.hpp"
#include "field/phase.hpp"
#include "flow/local_viscosity.hpp"
#include "grid/box.hpp"

namespace eulastic {

/// Traction on one wall: components x, y, z (0 along the normal) in its cells on this rank, x fastest; empty on ranks
/// that do not touch the wall.
struct WallStress {
  int direction = 0;
  bool high = false;
  std::array<std::vector<double>, 3> components;
  std::ptrdiff_t sy = 0, sz = 0;
  ConstView view(int c) const { return {components[c].data(), sy, sz}; }
};

/// Traction on all walls of the box. Reads one ghost layer of velocity (at `time`) and B.
std::vector<WallStress> wall_shear_stress(const Box &box, const BoundaryConditions &sides, double time,
                                          const EdgeViscosity &viscosity, const Field &velocity,
                                          const std::vector<Phase> &phases);

}  // namespace eulastic
