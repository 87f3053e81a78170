// A flow with all its parts, advanced step by step. No printing, no rank tests, no options.
#pragma once

#include "flow/limits.hpp"
#include "parts/flow.hpp"
#include "parts/flow_part.hpp"

#include <memory>

namespace eulastic {

class BoxedBodies;
class Looks;
class Projection;
class RigidBodies;
class RigidFlow;
class Scheme;
struct AdhesionSpec;
struct RigidLoad;
struct SurfaceMeasure;

class Solver {
public:
  /// What a scene has on the grid.
  struct Contents {
    bool open = false, bodies = false, surface_tension = false, membranes = false, rigid = false;
  };
  /// Fields of the work space that the method needs for it.
  static int work_fields(const Method &method, int dimension, const Contents &scene);
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
  Looks &looks() { return *looks_; }
  /// A part of this kind, or null where the scene has none.
  template <class Part>
  Part *part() const;

  /// Before prepare(). Collective.
  PetscErrorCode set_rigid(std::unique_ptr<RigidBodies> bodies);
  /// Bonds between surfaces; before prepare().
  void set_adhesion(const AdhesionSpec &spec);
  /// Sides with profiles that know the bodies; before prepare().
  void set_profiles(const BoxSides &sides) { flow_->spec.sides = sides; }
  /// Makes ghosts, B outside the bodies and active segments consistent; call after the initial fields are set.
  PetscErrorCode prepare();
  /// Instead of changing anything: makes ghosts and active segments from a state that was read. prepare() has run
  /// before, on a scene with the same phases.
  PetscErrorCode resume(long stages, long sweeps);
  /// Measures the flow: time step limits, WENO5's velocity scale.
  PetscErrorCode measure(FlowExtremes *extremes);
  TimeStepLimits limits(const FlowExtremes &extremes) const;
  /// Mends or forgets B where the grid does not resolve it. A part of the method: for what measure() found, before the
  /// step.
  PetscErrorCode forget_unresolved(const FlowExtremes &extremes);
  /// Advances by dt. `in_middle` is called with the velocity of the start and, with the staggered integrator, phases of
  /// the middle; weighed by the lengths of this step and the last, what it sees and what looks().behind() has seen give
  /// what belongs to the time of that velocity, to second order. `with_pressure` is called later, with the velocity of
  /// the start and the pressure of the middle: the same holds for what depends on these alone.
  PetscErrorCode step(double dt, const Look &in_middle = {}, const Look &with_pressure = {});

  // All of these are of the time of the velocity.

  /// Kinematic viscosities (flow/viscosity.hpp), until the next step; null where all are the fluid's.
  PetscErrorCode viscosity_now(const Field **viscosity);
  /// Energy of the surfaces and what the flow gives to it; zero without surface tension and membranes. `bodies`: what
  /// is known of the surface of every body, if there are labels and membranes.
  PetscErrorCode surface_energy(SurfaceEnergy *measured, std::vector<SurfaceMeasure> *bodies = nullptr);
  /// What forces of species and stretch forces do on the flow.
  PetscErrorCode force_power(double *power);

  /// Null where nothing is rigid.
  const RigidFaces *rigid() const { return flow_->rigid; }
  /// RigidFlow::loads(), none where nothing is rigid.
  PetscErrorCode rigid_loads(std::vector<RigidLoad> *loads);
  bool is_behind() const { return flow_->is_behind(); }
  /// One line if rigid bodies touch that should not, or if a body is at a side that volume crosses and cannot leave.
  const std::string &crowded() const { return flow_->crowded; }
  /// Viscous stages and pressure sweeps since the start.
  long stages() const;
  long sweeps() const;
  double sound_speed() const;
  /// All that is carried from one step to the next. Collective.
  PetscErrorCode carry(CarriedState *state);
  /// What the pressure solver remembers of earlier steps becomes 0.
  void clear_pressure_memory();
  /// The sides with the pressures that loads have now.
  BoxSides sides_now() const { return flow_->sides_now(); }
  /// Bytes of all fields of this rank, work space included.
  std::size_t bytes() const;

private:
  PetscErrorCode make_parts();

  std::unique_ptr<Flow> flow_;
  std::unique_ptr<Projection> projection_;
  std::unique_ptr<BoxedBodies> boxed_;
  std::unique_ptr<RigidFlow> rigid_;  ///< null where nothing is rigid
  std::vector<std::unique_ptr<FlowPart>> others_;
  std::unique_ptr<Scheme> scheme_;
  std::unique_ptr<Looks> looks_;
  std::unique_ptr<AdhesionSpec> adhesion_;  ///< null: nothing adheres
  long sweeps_before_ = 0;                  ///< a restart
};

template <class Part>
Part *Solver::part() const {
  for (FlowPart *part : flow_->parts)
    if (auto *found = dynamic_cast<Part *>(part)) return found;
  return nullptr;
}

}  // namespace eulastic
