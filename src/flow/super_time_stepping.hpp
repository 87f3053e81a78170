// Super time stepping of the viscosity: RKL2 (Meyer, Balsara & Aslam, J. Comput. Phys. 257, 2014) with all other terms
// of the momentum equation frozen. Needs ghost exchanges, but no global sums.
#pragma once

#include "base/petsc.hpp"
#include "field/boundaries.hpp"
#include "field/ghost_exchange.hpp"
#include "field/phase.hpp"
#include "field/rigid_faces.hpp"
#include "flow/viscosity.hpp"
#include "grid/domain.hpp"

namespace eulastic {

struct RigidMeans;

/// Returns the number of stages for dt if a single explicit step is stable up to dt_explicit: the least odd s >= 3 with
/// dt <= dt_explicit (s^2 + s - 2)/4. (An even s would leave the stiffest mode undamped.)
int rkl_stages(double dt, double dt_explicit);

/// Returns boundary conditions whose velocities are the changes of the given ones between two times.
BoundaryConditions sides_of_increment(const BoundaryConditions &sides, double from, double to);

/// Returns for every row of owned cells whether any phase exerts a force there.
std::vector<char> stressed_rows(const Box &box, const std::vector<Phase> &phases);

/// Velocity fields of super_time_step().
struct SuperTimeStepping {
  Field rate;         ///< M_0: dv/dt with the viscous term at the start and all other terms at the middle of the step
  Field slope;        ///< M_1: change in time of the elastic force per mass; an empty field: none
  Field now, before;  ///< work space for the increments W_j-1 and W_j-2
};

/// Input of a viscous step.
struct ViscousStep {
  const BoundaryConditions &sides;
  double time, dt;
  int stages;  ///< from rkl_stages(); or 1 for explicit Euler, which does not use `before`
  const Field &velocity;
  double viscosity;                   ///< kinematic viscosity of the fluid
  LocalViscosity *local = nullptr;    ///< variable viscosity: its stress replaces the Laplacian, except at cut faces
  std::vector<char> stressed{};       ///< stressed_rows(), needed with a slope: M_1 is 0 in other rows
  const RigidFaces *rigid = nullptr;  ///< rigid surfaces, which rate and slope already account for
  RigidMeans *means = nullptr;        ///< on entry values at `time`; on return their means in the viscous term, (28c)
};

/// Computes v* = v + W_s, where W' = L W + M_0 + (t - dt/2) M_1 over dt with the viscous term L, W = 0 at the start,
/// and W = U(t) - U(time) on moving walls. Without M_1 the jump of the elastic force at an interface, which the viscous
/// force balances at all times, would cause an error of order dt^1.5. Collective.
PetscErrorCode super_time_step(const Domain &domain, GhostExchange &exchange, const ViscousStep &step,
                               SuperTimeStepping &work, Field &velocity_star);

}  // namespace eulastic
