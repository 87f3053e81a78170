// The projection: computes the pressure increment that makes a velocity solenoidal, and corrects velocity and pressure,
// (8) to (13).
#pragma once

#include "base/petsc.hpp"
#include "field/field.hpp"
#include "parts/flow.hpp"
#include "pressure/pressure_solver.hpp"

#include <memory>

namespace eulastic {

/// Computes D* = rho div v* at the owned centres. v* needs one ghost.
PetscErrorCode compute_divergence(const Box &box, double density, const Field &velocity_star, Field &divergence);

/// Factors of the rotational update of the pressure: of D*, and of D* times the local kinematic viscosity.
struct RotationalUpdate {
  double uniform = 0, local = 0;
};

/// Owns the pressure solver and performs the projections of a flow.
class Projection {
public:
  /// Number of fields of the work space that are leased at the same time. `open`: there is an open boundary; `rigid`:
  /// there are rigid bodies.
  static int work_fields(const Method &method, bool open, bool rigid);
  /// Memory of the pressure solver beside the work space, in fields of the grid.
  static double fields(const Method &method, int dimension, bool rigid);

  explicit Projection(Flow *flow) : flow_(*flow) {}
  /// Creates the pressure solver of the method, which stores `memory` increments of earlier steps. Collective.
  PetscErrorCode create(int memory);
  PressureSolver &solver() const { return *solver_; }
  /// Access for replacing the solver.
  std::unique_ptr<PressureSolver> *owned_solver() { return &solver_; }

  /// Ends a step: makes Flow::velocity_star, with one valid ghost layer, the new velocity and updates the pressure to
  /// the end or the middle of the step. `viscosity`: LocalViscosity::fields if rotation.local is not 0. Collective.
  PetscErrorCode end_step(double dt, const RotationalUpdate &rotation, const Field &viscosity);
  /// Subtracts grad q from `velocity` and adds q to `pressure`, with the q that makes `velocity` solenoidal; `is_rate`:
  /// it is the time derivative of a velocity. Owned cells only. Collective.
  PetscErrorCode make_solenoidal(bool is_rate, Field &velocity, Field &pressure);

private:
  PetscErrorCode find_increment(double dt, double target, const Field &velocity, Field &pressure, Field &divergence,
                                Field &increment);
  PetscErrorCode correct(double dt, double rotation, const Field &divergence, const Field &increment, Field &velocity,
                         Field &pressure);

  Flow &flow_;
  std::unique_ptr<PressureSolver> solver_;
};

/// Projects the initial flow with the given velocities on the boundaries and, if no pressure is known, computes the
/// initial pressure without forces of bodies. Collective.
PetscErrorCode start_flow(Flow *flow, Projection *projection);

}  // namespace eulastic
