// Stabilised explicit viscosity: RKL2 (Meyer, Balsara & Aslam, JCP 257, 2014) around a frozen rest of the momentum
// equation. Only neighbour exchange, no global sums.
#pragma once

#include "field/ghost_exchange.hpp"
#include "field/walls.hpp"

namespace eulastic {

/// Stages for dt where a plain explicit step bears dt_explicit: the least odd s >= 3 with
/// dt <= dt_explicit (s^2 + s - 2)/4. (An even s leaves the stiffest mode undamped.)
int rkl_stages(double dt, double dt_explicit);

/// Work space of super_time_step, three velocity blocks.
struct SuperTimeStepping {
  FieldBlock rate;           ///< M_0 = dv/dt at the start of the step, viscosity included; in
  FieldBlock now, before;    ///< increments W_j-1 and W_j-2
};

/// One stage is plain explicit Euler and needs no `before`. v* = v + W_s, where W' = nu lap W + M_0 over dt, W = 0 at the start and U(t) - U(time) on moving walls.
PetscErrorCode super_time_step(const Grid &grid, GhostExchange &exchange, const Walls &walls,
                               double kinematic_viscosity, double time, double dt, int stages,
                               const FieldBlock &velocity, SuperTimeStepping &work, FieldBlock &velocity_star);

}  // namespace eulastic
