// The projection: the increment of the pressure that makes a velocity solenoidal, and what it does to both, (8) to
// (13).
#pragma once

#include "base/petsc.hpp"
#include "field/field.hpp"
#include "parts/flow.hpp"
#include "pressure/pressure_solver.hpp"

#include <memory>

namespace eulastic {

/// D* = rho div v* at centres. Needs one ghost of v*. Rows are wrapped by one around a periodic x.
PetscErrorCode compute_divergence(const Box &box, double density, const Field &velocity_star, Field &divergence);

/// Of the rotational update of the pressure: the factor of D*, and that of the place's kinematic viscosity times D*.
struct PressureRotation {
  double uniform = 0, local = 0;
};

class Projection {
public:
  /// Fields of the work space that it holds at once; `open`: the pressure is given on a side; `rigid`: there are
  /// bodies.
  static int work_fields(const Method &method, bool open, bool rigid);

  explicit Projection(Flow *flow) : flow_(*flow) {}
  /// Makes the pressure solver that the scheme asks for, which remembers so many increments of earlier steps.
  /// Collective.
  PetscErrorCode create(int memory);
  PressureSolver &solver() const { return *solver_; }
  /// For another one to take its place.
  std::unique_ptr<PressureSolver> *owned_solver() { return &solver_; }

  /// Ends a step: Flow::velocity_star, one ghost, becomes the velocity, and the pressure that of the end or the middle
  /// of the step. `viscosity`: LocalViscosity::fields, where rotation.local is not 0. Collective.
  PetscErrorCode end_step(double dt, const PressureRotation &rotation, const Field &viscosity);
  /// v -= grad q and p += q for the q that makes v solenoidal: a velocity, or how it changes in time. Owned cells.
  /// Collective.
  PetscErrorCode make_solenoidal(bool is_rate, Field &velocity, Field &pressure);

private:
  PetscErrorCode find_increment(double dt, double target, const Field &velocity, Field &pressure, Field &divergence,
                                Field &increment);
  PetscErrorCode correct(double dt, double rotation, const Field &divergence, const Field &increment, Field &velocity,
                         Field &pressure);

  Flow &flow_;
  std::unique_ptr<PressureSolver> solver_;
};

/// Makes the flow at the start pass through the sides as it is given there and, if there is no pressure yet, finds the
/// one that goes with it, but for forces of bodies. Collective.
PetscErrorCode start_flow(Flow *flow, Projection *projection);

}  // namespace eulastic
