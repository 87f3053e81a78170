// A flow with all its parts, advanced step by step. It neither prints nor knows options or the number of ranks.
#pragma once

#include "flow/limits.hpp"
#include "parts/flow.hpp"
#include "parts/flow_part.hpp"

#include <memory>

namespace eulastic {

class BoxedBodies;
class SynchronisedState;
class Projection;
class RigidBodies;
class RigidFlow;
class Scheme;
struct AdhesionSpec;
struct RigidLoad;
struct SurfaceMeasure;
struct ViscosityContrast;

class Solver {
public:
  /// Contents of a scene that determine how much memory its fields take. Surface tension and membranes are those of
  /// bodies on the grid; `travel`: rigid bodies that do; `elastic`: any body that carries B.
  struct Contents {
    bool open = false, bodies = false, surface_tension = false, membranes = false, rigid = false;
    bool travel = false, elastic = false;
    int loaded_outlets = 0;
  };
  /// Number of work-space fields that the method needs for the scene.
  static int work_fields(const Method &method, int dimension, const Contents &scene);
  /// Doubles per cell of all fields, without those of the species themselves.
  static double fields(const SolverSpec &spec, int dimension, const Contents &scene, const ViscosityContrast &contrast);
  Solver();
  Solver(Solver &&) noexcept;
  Solver &operator=(Solver &&) noexcept;
  ~Solver();
  /// Allocates velocity and pressure on `domain` (all zero) and the work space of the method.
  PetscErrorCode create(const Domain &domain, const SolverSpec &spec);

  const Domain &domain() const { return flow_->domain; }
  const SolverSpec &spec() const { return flow_->spec; }
  GhostExchange &exchange() { return flow_->exchange; }
  State &state() { return flow_->now; }
  const State &state() const { return flow_->now; }
  BodyTracker &bodies() { return flow_->bodies; }
  Flow &flow() { return *flow_; }
  BoxedBodies &boxed() const { return *boxed_; }
  SynchronisedState &synchronised() { return *synchronised_; }
  /// The part of this type, or null if the scene has none.
  template <class Part>
  Part *part() const;

  /// Sets the rigid bodies; before prepare(). Collective.
  PetscErrorCode set_rigid(std::unique_ptr<RigidBodies> bodies);
  /// Sets the bonds between surfaces; before prepare().
  void set_adhesion(const AdhesionSpec &spec);
  /// Sets boundaries whose profiles depend on the bodies; before prepare().
  void set_profiles(const BoundaryConditions &sides) { flow_->spec.sides = sides; }
  /// Creates the parts and makes ghosts, B outside the bodies and active segments consistent; call after the initial
  /// fields are set. Collective.
  PetscErrorCode prepare();
  /// Makes ghosts and active segments consistent after a state has been read. prepare() must have run before, on a
  /// scene with the same phases. `stages`, `sweeps`: totals of the run so far. Collective.
  PetscErrorCode resume(long stages, long sweeps);
  /// Measures the extremes of the flow, which set the limits of the time step and the velocity scale of WENO5.
  /// Collective.
  PetscErrorCode measure(FlowExtremes *extremes);
  TimeStepLimits limits(const FlowExtremes &extremes) const;
  /// Repairs B where the grid does not resolve it. This is part of the method: call it before a step, with the result
  /// of measure(). Collective.
  PetscErrorCode reset_unresolved(const FlowExtremes &extremes);
  /// Advances the flow by dt. `in_middle` is called with the velocity of the start and, with the staggered method, the
  /// phases of the middle; averages of its measures and those of synchronised().at_half_step(), weighted by the lengths
  /// of this step and the last, are measures at the time of that velocity, to second order. `with_pressure` is called
  /// later, with the velocity of the start and the pressure of the middle; the same holds for measures of these two.
  /// Collective.
  PetscErrorCode step(double dt, const Observer &in_middle = {}, const Observer &with_pressure = {});

  // Measures at the time of the velocity. Collective.

  /// Kinematic viscosities (flow/viscosity.hpp), valid until the next step; null if all bodies have the viscosity of
  /// the fluid.
  PetscErrorCode viscosity_now(const Field **viscosity);
  /// Energy of surfaces and the power that the flow supplies to it; zero without surface tension and membranes.
  /// `bodies`: measures of the surface of every body, if there are labels and membranes.
  PetscErrorCode surface_energy(SurfaceEnergy *measured, std::vector<SurfaceMeasure> *bodies = nullptr);
  /// Power of the forces of species and of stretch forces on the flow.
  PetscErrorCode force_power(double *power);

  /// Null if the scene has no rigid bodies.
  const RigidFaces *rigid() const { return flow_->rigid; }
  /// Result of RigidFlow::loads(); empty if the scene has no rigid bodies.
  PetscErrorCode rigid_loads(std::vector<RigidLoad> *loads);
  bool phases_lag() const { return flow_->phases_lag(); }
  /// One line if rigid bodies overlap that must not, or if a body that cannot leave has reached a boundary that volume
  /// crosses; else empty.
  const std::string &stop_reason() const { return flow_->stop_reason; }
  /// Viscous stages and pressure iterations since the start of the run.
  long stages() const;
  long sweeps() const;
  double sound_speed() const;
  /// Lists everything that persists from one step to the next. Collective.
  PetscErrorCode carry(CarriedState *state);
  /// Sets the pressure solver's memory of earlier steps to 0.
  void clear_pressure_memory();
  /// The boundaries with the present pressures of those that have loads.
  BoundaryConditions sides_now() const { return flow_->sides_now(); }
  /// Bytes of all fields of this rank, work space included.
  std::size_t bytes() const;

private:
  PetscErrorCode make_parts();

  std::unique_ptr<Flow> flow_;
  std::unique_ptr<Projection> projection_;
  std::unique_ptr<BoxedBodies> boxed_;
  std::unique_ptr<RigidFlow> rigid_;  ///< null if the scene has no rigid bodies
  std::vector<std::unique_ptr<FlowPart>> owned_parts_;
  std::unique_ptr<Scheme> scheme_;
  std::unique_ptr<SynchronisedState> synchronised_;
  std::unique_ptr<AdhesionSpec> adhesion_;  ///< null if nothing adheres
  long sweeps_before_ = 0;                  ///< pressure iterations before a restart
};

template <class Part>
Part *Solver::part() const {
  for (FlowPart *part : flow_->parts)
    if (auto *found = dynamic_cast<Part *>(part)) return found;
  return nullptr;
}

}  // namespace eulastic
