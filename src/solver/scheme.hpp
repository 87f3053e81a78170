// What both schemes of a step share: the verbs between which they differ, and the viscosity of the place.
#pragma once

#include "flow/limits.hpp"
#include "flow/viscosity.hpp"
#include "parts/flow.hpp"
#include "parts/flow_part.hpp"

namespace eulastic {

class Projection;
struct PressureRotation;

class Scheme {
public:
  Scheme(Flow *flow, Projection *projection) : flow_(*flow), projection_(*projection) {}
  virtual ~Scheme() = default;
  /// Fields of the work space that a prediction holds, with `forces` of them for the forces of surfaces.
  static int work_fields(const Method &method, int dimension, int forces);
  /// Whether a step begins with the pressure expected in its middle, rather than with that of the last one. `travel`:
  /// rigid bodies do.
  static bool expects_pressure(const Method &method, const ViscosityContrast &contrast, bool travel);

  /// Memory, once the phases of the state are known.
  virtual PetscErrorCode start();
  /// Advances the state by dt. `in_middle` is called with the velocity of the start and phases of the middle, if they
  /// come there; `with_pressure` with the velocity of the start, in Flow::velocity_star, and the pressure of the end of
  /// the projection.
  virtual PetscErrorCode step(double dt, const Look &in_middle, const Look &with_pressure) = 0;
  virtual std::size_t bytes() const;

  TimeStepLimits limits(const FlowExtremes &extremes) const;
  /// Kinematic viscosities (flow/local_viscosity.hpp) of phases; null where all are the fluid's.
  PetscErrorCode find_viscosity_of(const std::vector<Phase> &phases, const Field **viscosity);
  long stages() const { return stages_; }  ///< viscous ones, since the start
  void set_stages(long stages) { stages_ = stages; }

protected:
  /// Viscosities, and with the largest tr B of every phase what they mean for the time step.
  ViscosityContrast contrast(const std::vector<double> &trace) const;
  /// The fluid, without a viscosity where that is the place's: its stress is added by itself.
  PetscErrorCode find_viscosity(Fluid *fluid);
  PetscErrorCode add_local_viscous_force(double scale, Field &to);
  PetscErrorCode move_bodies(double dt);
  /// From the prediction to the end of the step.
  PetscErrorCode project(double dt, const PressureRotation &rotation, const Look &with_pressure);
  /// Labels follow their bodies, and the state is that of the end of the step.
  PetscErrorCode end_step(double dt);

  Flow &flow_;
  Projection &projection_;
  LocalViscosity viscosity_;  ///< of the step, where bodies have their own; else empty
  long stages_ = 0;
};

}  // namespace eulastic
