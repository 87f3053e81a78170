// Stabilised explicit viscosity: RKL2 (Meyer, Balsara & Aslam, JCP 257, 2014) around a frozen rest of the momentum
// equation. Only neighbour exchange, no global sums.
#pragma once

#include "base/petsc.hpp"
#include "field/ghost_exchange.hpp"
#include "field/phase.hpp"
#include "field/rigid_faces.hpp"
#include "field/sides.hpp"
#include "grid/domain.hpp"

namespace eulastic {

struct RigidMeans;

/// Stages for dt where a plain explicit step bears dt_explicit: the least odd s >= 3 with
/// dt <= dt_explicit (s^2 + s - 2)/4. (An even s leaves the stiffest mode undamped.)
int rkl_stages(double dt, double dt_explicit);

/// Whether any phase stresses a row of cells, for all of them.
std::vector<char> stressed_rows(const Box &box, const std::vector<Phase> &phases);

/// Input and work space of super_time_step, velocity blocks.
struct SuperTimeStepping {
  Field rate;         ///< M_0: dv/dt with the viscous term of the start and all else of the middle of the step
  Field slope;        ///< M_1: how the elastic force per mass changes in time; empty = not at all
  Field now, before;  ///< increments W_j-1 and W_j-2
};

/// v* = v + W_s, where W' = nu lap W + M_0 + (t - dt/2) M_1 over dt, W = 0 at the start and U(t) - U(time) on moving
/// walls. Without M_1 the jump of the elastic force at an interface, which the viscous one balances at every moment,
/// would leave an error of order dt^1.5. M_1 vanishes in rows of cells that are not `stressed`. One stage is plain
/// explicit Euler and needs no `before`. `rigid` may be null; `rate` and slope have seen its surfaces. `means` (may be
/// null) begin with what is at `time` and become those that the viscous term has acted with.
PetscErrorCode super_time_step(const Domain &domain, GhostExchange &exchange, const BoxSides &box_sides,
                               double kinematic_viscosity, double time, double dt, int stages,
                               const std::vector<char> &stressed, const Field &velocity, SuperTimeStepping &work,
                               Field &velocity_star, const RigidFaces *rigid = nullptr, RigidMeans *means = nullptr);

}  // namespace eulastic
