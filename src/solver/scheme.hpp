// The interface of a step and the routines that both methods share.
#pragma once

#include "flow/limits.hpp"
#include "flow/viscosity.hpp"
#include "parts/flow.hpp"
#include "parts/flow_part.hpp"

namespace eulastic {

class Projection;
struct RotationalUpdate;

class Scheme {
public:
  Scheme(Flow *flow, Projection *projection) : flow_(*flow), projection_(*projection) {}
  virtual ~Scheme() = default;
  /// Number of work-space fields that a prediction holds, `forces` of them for the forces of surfaces.
  static int work_fields(const Method &method, int dimension, int forces);
  /// Memory beside the work space and the parts of the flow, in fields of the grid. `bodies`: any species; `rigid`,
  /// `travel`: rigid bodies, and such that travel.
  static double fields(const Method &method, int dimension, const ViscosityContrast &contrast, bool bodies, bool rigid,
                       bool travel);
  /// Whether a step begins with the pressure extrapolated to its middle rather than with the last one. `travel`:
  /// whether rigid bodies travel.
  static bool extrapolates_pressure(const Method &method, const ViscosityContrast &contrast, bool travel);

  /// Allocates memory, once the phases of the state are known.
  virtual PetscErrorCode start();
  /// Advances the state by dt. `in_middle` is called with the velocity of the start and the phases of the middle
  /// (method `fast` only); `with_pressure` with the velocity of the start, in Flow::velocity_star, and the pressure at
  /// the end of the projection.
  virtual PetscErrorCode step(double dt, const Observer &in_middle, const Observer &with_pressure) = 0;
  virtual std::size_t bytes() const;

  TimeStepLimits limits(const FlowExtremes &extremes) const;
  /// Kinematic viscosities (flow/local_viscosity.hpp) for the given phases; null if all bodies have the viscosity of
  /// the fluid.
  PetscErrorCode find_viscosity_of(const std::vector<Phase> &phases, const Field **viscosity);
  long stages() const { return stages_; }  ///< viscous stages since the start
  void set_stages(long stages) { stages_ = stages; }

protected:
  /// Range of viscosities and, with the largest tr B of every phase (empty: not used), the resulting limits of the time
  /// step.
  ViscosityContrast contrast(const std::vector<double> &trace) const;
  /// Sets *fluid to the fluid of the flow, with viscosity 0 if the viscosity varies: its force is then added
  /// separately.
  PetscErrorCode find_viscosity(Fluid *fluid);
  PetscErrorCode add_local_viscous_force(double scale, Field &to);
  PetscErrorCode move_bodies(double dt);
  /// The part of a step after the prediction: projection, new pressure, new velocity with ghosts.
  PetscErrorCode project(double dt, const RotationalUpdate &rotation, const Observer &with_pressure);
  /// Updates labels if due, calls end_step() of the parts, and sets time and number of the state.
  PetscErrorCode end_step(double dt);

  Flow &flow_;
  Projection &projection_;
  LocalViscosity viscosity_;  ///< of this step if bodies have their own viscosity; else empty
  long stages_ = 0;
};

}  // namespace eulastic
