// Stabilised explicit viscosity: RKL2 (Meyer, Balsara & Aslam, JCP 257, 2014) around a frozen rest of the momentum
// equation. Only neighbour exchange, no global sums.
#pragma once

#include "base/petsc.hpp"
#include "field/ghost_exchange.hpp"
#include "field/phase.hpp"
#include "field/rigid_faces.hpp"
#include "field/sides.hpp"
#include "flow/viscosity.hpp"
#include "grid/domain.hpp"

namespace eulastic {

struct RigidMeans;

/// Stages for dt where a plain explicit step bears dt_explicit: the least odd s >= 3 with
/// dt <= dt_explicit (s^2 + s - 2)/4. (An even s leaves the stiffest mode undamped.)
int rkl_stages(double dt, double dt_explicit);

/// Boundaries of an increment of the velocity: walls move, and the inflow is, by how much it differs between two times.
BoxSides sides_of_increment(const BoxSides &sides, double from, double to);

/// Whether any phase stresses a row of cells, for all of them.
std::vector<char> stressed_rows(const Box &box, const std::vector<Phase> &phases);

/// Fields of super_time_step(), velocity blocks.
struct SuperTimeStepping {
  Field rate;         ///< M_0: dv/dt with the viscous term of the start and all else of the middle of the step
  Field slope;        ///< M_1: how the elastic force per mass changes in time; empty: not at all
  Field now, before;  ///< work space: increments W_j-1 and W_j-2
};

/// A step in viscous stages.
struct ViscousStep {
  const BoxSides &sides;
  double time, dt;
  int stages;  ///< of rkl_stages(); or 1, plain explicit Euler, which needs no `before`
  const Field &velocity;
  double viscosity;                   ///< kinematic, of the fluid
  LocalViscosity *local = nullptr;    ///< where it varies: its stress replaces the Laplacian, except at cut faces
  std::vector<char> stressed{};       ///< stressed_rows(), with a slope: M_1 vanishes in the others
  const RigidFaces *rigid = nullptr;  ///< whose surfaces rate and slope have seen
  RigidMeans *means = nullptr;        ///< begin with values at `time`, become those the viscous term has acted with
};

/// v* = v + W_s, where W' = L W + M_0 + (t - dt/2) M_1 over dt, L the viscous term, W = 0 at the start and
/// U(t) - U(time) on moving walls. Without M_1 the jump of the elastic force at an interface, which the viscous one
/// balances at every moment, would leave an error of order dt^1.5.
PetscErrorCode super_time_step(const Domain &domain, GhostExchange &exchange, const ViscousStep &step,
                               SuperTimeStepping &work, Field &velocity_star);

}  // namespace eulastic
