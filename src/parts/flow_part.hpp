// A part of a flow: one capability of a scene, such as bodies on the grid, membranes, surface tension, rigid bodies or
// open boundaries. A step calls each of these functions for all parts, in the order in which Solver::make_parts creates
// them; by default a function does nothing.
#pragma once

#include "base/petsc.hpp"
#include "field/boundaries.hpp"
#include "field/phase.hpp"
#include "field/surface_marker.hpp"

#include <cmath>
#include <functional>
#include <vector>

namespace eulastic {

struct CarriedState;
/// A callback that measures or writes the flow at some point of a step.
using Observer = std::function<PetscErrorCode()>;

/// Weights of the advection term of this step and of the last one: (1, 0) is Euler, (1 + r/2, -r/2) Adams-Bashforth of
/// second order.
struct AdvectionWeights {
  double now = 1, before = 0;
};

/// The data of a step that the momentum equation needs.
struct MomentumStep {
  double force_time;  ///< time at which the body force is evaluated
  double dt;
  double speed_scale;  ///< typical |v|, for WENO5
  AdvectionWeights weights;
};

/// Epsilon of WENO5 for a field of the given scale.
inline double weno_epsilon(double scale) { return 1e-6 * scale * scale; }

/// The target to which parts add their terms of dv/dt, at owned faces.
struct MomentumRate {
  const MomentumStep &step;
  double scale;          ///< factor with which rates are added to `field`
  Field &field;          ///< the rate; with plain Euler the new velocity itself
  Field *advection;      ///< receives -v.grad v; null if no later step needs it
  WeightedTarget slope;  ///< receives the forces as well, from which their change in time follows
  /// Kinematic viscosity whose force is in the rate already; add_local_viscous_force() adds that of a varying
  /// viscosity.
  double viscosity_included;
};

/// Phases and bodies in boxes at the time of State::velocity, for measures.
struct SynchronisedBodies {
  const std::vector<Phase> &phases;
  const std::vector<BodyInBox> &boxed;
};

class FlowPart {
public:
  virtual ~FlowPart() = default;

  /// Bytes of the part's own fields on this rank.
  virtual std::size_t bytes() const { return 0; }
  /// Lists everything that the part keeps from one step to the next.
  virtual PetscErrorCode carry(CarriedState *) { return 0; }

  /// Called once, when the owned cells of all fields are set and the ghosts of velocity and pressure are valid.
  virtual PetscErrorCode start() { return 0; }
  /// Called at a restart after the state has been read, before the ghosts of the velocity behind boundaries are filled.
  virtual PetscErrorCode begin_resume() { return 0; }
  /// Called at a restart when all ghosts of velocity and pressure are valid.
  virtual PetscErrorCode resume() { return 0; }

  /// Sets owned faces of `velocity` whose velocity is prescribed, at `time`.
  virtual PetscErrorCode prescribe_velocity(double /*time*/, Field & /*velocity*/) { return 0; }
  /// Sets the present pressures of boundaries.
  virtual void set_boundary_pressures(BoundaryConditions *) const {}
  /// Shortest period of anything the part moves, in time; the time step resolves it.
  virtual double shortest_period() const { return HUGE_VAL; }
  /// Largest time step that the part's forces permit.
  virtual double largest_step() const { return HUGE_VAL; }

  // In the order of a step:

  /// Called first in a step.
  virtual PetscErrorCode begin_step() { return 0; }
  /// slope -= force / dt, with the force per mass of bodies at their old positions, before move(dt).
  virtual PetscErrorCode begin_slope(double /*dt*/, Field & /*slope*/) { return 0; }
  /// Moves the part's bodies over dt with State::velocity. `phases`: those of the state, or copies for measures.
  virtual PetscErrorCode move(double /*dt*/, std::vector<Phase> * /*phases*/) { return 0; }
  /// Called before the prediction of a step of dt: bodies are at the positions where their forces act, the velocity is
  /// that of the start.
  virtual PetscErrorCode prepare(double /*dt*/) { return 0; }
  /// Called after prepare(), when the pressure has its ghosts.
  virtual PetscErrorCode begin_rate(const MomentumStep &) { return 0; }
  /// Adds the part's terms to the rate of momentum.
  virtual PetscErrorCode add_rate(const MomentumRate &) { return 0; }
  /// Marks the rows of owned cells (Box::rows) on whose faces add_rate() adds to the slope, other than those of
  /// stressed_rows().
  virtual void mark_forced_rows(std::vector<char> *) const {}
  /// Changes the complete rate where the flow meets something that is not fluid.
  virtual PetscErrorCode close_rate(const MomentumRate &) { return 0; }
  /// Prescribes faces of Flow::velocity_star, which has been predicted, without ghosts, for the time dt after that of
  /// the state.
  virtual PetscErrorCode constrain(double /*dt*/) { return 0; }
  /// Called when the pressure increment for `divergence` (times density, of Flow::velocity_star) is known, before it
  /// corrects velocity and pressure.
  virtual PetscErrorCode begin_correction(Field & /*divergence*/) { return 0; }
  /// Called before an increment corrects Flow::velocity_star; not if the increment is a formula
  /// (PressureSolver::formula()).
  virtual PetscErrorCode observe_increment(const Field &) { return 0; }
  /// Called after an increment has corrected a velocity of `time` over dt.
  virtual PetscErrorCode correct(double /*time*/, double /*dt*/, const Field & /*increment*/, Field & /*velocity*/) {
    return 0;
  }
  /// Called when Flow::velocity_star and the pressure are those of the end of the step. The part may change both by a
  /// further increment; `increment` is empty if it is a formula.
  virtual PetscErrorCode end_projection(double /*dt*/, const Field & /*divergence*/, Field & /*increment*/) {
    return 0;
  }
  /// Fills phases of bodies whose position is a function of time alone, at `time`.
  virtual PetscErrorCode position_phases(double /*time*/, std::vector<Phase> * /*phases*/) { return 0; }
  /// Called after the labels and reference cells of all bodies have been updated.
  virtual PetscErrorCode update_after_labels() { return 0; }
  /// Called last in a step; time and number of the state are still those of its start.
  virtual PetscErrorCode end_step() { return 0; }

  // Between the steps:

  /// Repairs B where the grid does not resolve it. `trace`: the largest tr B of every species. Collective.
  virtual PetscErrorCode reset_unresolved(const std::vector<double> & /*trace*/) { return 0; }
  /// Makes the part's data of a phase on the grid consistent after its owned cells have been set. GridBodies, the first
  /// of all parts, finds the occupied rows.
  virtual PetscErrorCode rebuild_derived_fields(Phase *) { return 0; }
  /// Called after a body with this label has been added to phase `number` on the grid, whose derived fields are valid.
  virtual PetscErrorCode observe_new_body(const Phase &, int /*number*/, int /*label*/) { return 0; }
  /// Called after bodies have been removed from phases on the grid.
  virtual PetscErrorCode observe_removed_bodies() { return 0; }
  /// Adds the power of the part's forces on the flow.
  virtual PetscErrorCode add_power(const SynchronisedBodies &, double * /*power*/) { return 0; }
  /// Adds energy and power of the part's surfaces, and samples of all owned cells at labelled membranes (null: none
  /// wanted).
  virtual PetscErrorCode add_surface_energy(const SynchronisedBodies &, SurfaceEnergy *,
                                            std::vector<SurfaceSample> * /*samples*/) {
    return 0;
  }
};

}  // namespace eulastic
