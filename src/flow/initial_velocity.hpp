// Analytical initial velocities, evaluated at the faces.
#pragma once

#include "field/boundaries.hpp"

#include <string>
#include <vector>

namespace eulastic {

/// In shear_wave_ab component a varies along b.
enum class InitialVelocity {
  zero,
  uniform,
  taylor_green,
  taylor_green_3d,
  shear_layer,
  couette,
  poiseuille,
  shear_wave_xy,
  shear_wave_xz,
  shear_wave_yx,
  shear_wave_yz,
  shear_wave_zx,
  shear_wave_zy,
  random
};
/// Returns the names as in the options, in the order of the enum.
const std::vector<std::string> &initial_velocity_names();
/// Returns {a, b} for shear_wave_ab, {-1, -1} for the others.
std::array<int, 2> shear_wave_directions(InitialVelocity kind);

/// Parameters of the initial velocity.
struct InitialFlow {
  InitialVelocity kind = InitialVelocity::zero;
  double amplitude = 1;  ///< A, length / time; not used by zero, uniform and couette
  Real3 mean{};          ///< added to every flow
};

/// Sets u, v (, w) of `velocity` at all owned faces, including those on open high boundaries. Faces with index N of
/// other directions and ghosts are set by fill_wall_ghosts_velocity and the exchange. The value at a face depends on
/// its position alone, so that the bits do not depend on the ranks. The flow is solenoidal up to the truncation error
/// of the grid; a projection must follow.
void set_initial_velocity(const Box &box, const BoundaryConditions &sides, const InitialFlow &flow, Field &velocity);

}  // namespace eulastic
