// A part of a flow: one capability of a scene (bodies on the grid, membranes, surface tension, rigid bodies, open
// sides ...) as a step sees it. A step calls each function for all parts, in the order in which Solver::make_parts
// lists them; a part does nothing in those that do not concern it.
#pragma once

#include "base/petsc.hpp"
#include "field/phase.hpp"
#include "field/sides.hpp"
#include "field/surface_marker.hpp"

#include <cmath>
#include <functional>
#include <vector>

namespace eulastic {

struct CarriedState;
/// Called while a flow can be looked at.
using Look = std::function<PetscErrorCode()>;

/// How the advection term of this and the last step enter: 1, 0 is Euler, 1 + r/2, -r/2 Adams-Bashforth 2.
struct AdvectionWeights {
  double now = 1, before = 0;
};

/// What the momentum equation needs to know of a step.
struct MomentumStep {
  double force_time;  ///< when the body force is taken
  double dt;
  double speed_scale;  ///< typical |v|, for WENO5
  AdvectionWeights weights;
};

/// WENO5's epsilon for a field of the given scale.
inline double weno_epsilon(double scale) { return 1e-6 * scale * scale; }

/// Where parts add their share of dv/dt, at owned faces.
struct MomentumRate {
  const MomentumStep &step;
  double scale;          ///< the field gets so many times the rate
  Field &field;          ///< the rate, or the velocity that a step of plain Euler leads to
  Field *advection;      ///< -v.grad v of now; null where no step needs it again
  WeightedTarget slope;  ///< gets the force as well, to say how it changes in time
  /// Of the kinematic viscosity, how much is in the rate already; the rest is that of the place.
  double viscosity_included;
};

/// The flow at a time, for what measures it: State::velocity, and phases and bodies in boxes that have been brought to
/// its time.
struct FlowLook {
  const std::vector<Phase> &phases;
  const std::vector<BodyInBox> &boxed;
};

class FlowPart {
public:
  virtual ~FlowPart() = default;

  /// Bytes of its own fields on this rank.
  virtual std::size_t bytes() const { return 0; }
  /// Names all that it carries from one step to the next.
  virtual PetscErrorCode carry(CarriedState *) { return 0; }

  /// Once, when the owned cells of all fields are set and the ghosts of velocity and pressure are known.
  virtual PetscErrorCode start() { return 0; }
  /// A state has been read in place of that of the start(): before ghosts of the velocity behind sides are set.
  virtual PetscErrorCode recall() { return 0; }
  /// The same, when all ghosts of velocity and pressure are known.
  virtual PetscErrorCode resume() { return 0; }

  /// Gives owned faces whose velocity is prescribed their values at `time`.
  virtual PetscErrorCode impose(double /*time*/, Field & /*velocity*/) { return 0; }
  /// Gives sides of the box the pressures that they have now.
  virtual void give_pressures(BoxSides *) const {}
  /// Of what it moves, in time; the time step resolves it.
  virtual double shortest_period() const { return HUGE_VAL; }
  /// The largest time step that what it adds to the flow permits.
  virtual double largest_step() const { return HUGE_VAL; }

  // In the order of a step.

  /// Before anything of a step.
  virtual PetscErrorCode begin_step() { return 0; }
  /// slope -= force / dt: the force per mass of its bodies where they are, before move(dt).
  virtual PetscErrorCode begin_slope(double /*dt*/, Field & /*slope*/) { return 0; }
  /// Moves its bodies over dt with State::velocity. `phases`: those of the state, or copies that are looked at.
  virtual PetscErrorCode move(double /*dt*/, std::vector<Phase> * /*phases*/) { return 0; }
  /// The state is about to be advanced by dt: bodies are where they act from, the velocity is that of the start.
  virtual PetscErrorCode prepare(double /*dt*/) { return 0; }
  /// The same once the pressure has its ghosts.
  virtual PetscErrorCode begin_rate(const MomentumStep &) { return 0; }
  /// Adds to the rate of momentum.
  virtual PetscErrorCode add_rate(const MomentumRate &) { return 0; }
  /// Marks rows of owned cells (Box::rows) on whose faces add_rate() adds to the slope, but for those that
  /// stressed_rows() knows.
  virtual void mark_forced_rows(std::vector<char> *) const {}
  /// Changes the rate where the flow meets something that is not fluid, when all have added to it.
  virtual PetscErrorCode close_rate(const MomentumRate &) { return 0; }
  /// Flow::velocity_star has been predicted, without ghosts, for a time dt after that of the state.
  virtual PetscErrorCode constrain(double /*dt*/) { return 0; }
  /// The increment of the pressure for a divergence, times density, of Flow::velocity_star has been found, and is about
  /// to correct velocity and pressure.
  virtual PetscErrorCode begin_correction(Field & /*divergence*/) { return 0; }
  /// An increment, unless it is a formula (PressureSolver::formula()), is about to correct Flow::velocity_star.
  virtual PetscErrorCode see_increment(const Field &) { return 0; }
  /// An increment has corrected a velocity of `time` over dt.
  virtual PetscErrorCode correct(double /*time*/, double /*dt*/, const Field & /*increment*/, Field & /*velocity*/) {
    return 0;
  }
  /// Flow::velocity_star and the pressure are those of the end of the step, but for what the part changes by another
  /// increment; that is empty where it is a formula.
  virtual PetscErrorCode end_projection(double /*dt*/, const Field & /*divergence*/, Field & /*increment*/) {
    return 0;
  }
  /// Phases of bodies that are functions of time alone get their places at `time`.
  virtual PetscErrorCode place(double /*time*/, std::vector<Phase> * /*phases*/) { return 0; }
  /// Labels and references have followed their bodies.
  virtual PetscErrorCode follow() { return 0; }
  /// The step is done, but time and number of the state are those of its start.
  virtual PetscErrorCode end_step() { return 0; }

  // At any time between the steps.

  /// Owned cells of a phase of the grid have been set (Flow::settle()): makes what the part keeps of it consistent.
  /// GridBodies, the first of all parts, finds its rows.
  virtual PetscErrorCode settle(Phase *) { return 0; }
  /// A body with this label has come into a phase of the grid, whose number is given and which is settled.
  virtual PetscErrorCode see_new_body(const Phase &, int /*number*/, int /*label*/) { return 0; }
  /// Bodies have been taken out of phases of the grid.
  virtual PetscErrorCode see_bodies_leave() { return 0; }
  /// Adds what its forces do on the flow.
  virtual PetscErrorCode add_power(const FlowLook &, double * /*power*/) { return 0; }
  /// Adds energy and power of its surfaces; `samples`: of all owned cells at labelled membranes, may be null.
  virtual PetscErrorCode add_surface_energy(const FlowLook &, SurfaceEnergy *,
                                            std::vector<SurfaceSample> * /*samples*/) {
    return 0;
  }
};

}  // namespace eulastic
