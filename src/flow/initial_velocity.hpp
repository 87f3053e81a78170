// The flow a run starts from, written pointwise on the faces.
#pragma once

#include "field/sides.hpp"

#include <string>
#include <vector>

namespace eulastic {

/// shear_wave_ab: component a varies along b.
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
/// Their names, in the order of the enum.
const std::vector<std::string> &initial_velocity_names();
/// {a, b} of shear_wave_ab, {-1, -1} of the others.
std::array<int, 2> shear_wave_directions(InitialVelocity kind);

struct InitialFlow {
  InitialVelocity kind = InitialVelocity::zero;
  double amplitude = 1;  ///< A, length / time; zero, uniform and couette do not use it
  Real3 mean{};          ///< added to every flow
};

/// Writes u, v (, w) of `velocity` at all owned faces, those of open high sides too; index N of other directions and
/// ghosts are left to fill_wall_ghosts_velocity and the exchange. The value at a face depends on its position alone, so
/// the bits do not depend on the ranks. Solenoidal up to the truncation error of the grid: project it.
void set_initial_velocity(const Box &box, const BoxSides &sides, const InitialFlow &flow, Field &velocity);

}  // namespace eulastic
