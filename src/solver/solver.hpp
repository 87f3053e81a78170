// One time step of the method, as verbs in its order. No printing, no rank tests, no options.
#pragma once

#include "base/petsc.hpp"
#include "bodies/measures.hpp"
#include "boxes/free_bodies.hpp"
#include "drops/surface_tension.hpp"
#include "field/fluid.hpp"
#include "field/ghost_exchange.hpp"
#include "field/work_space.hpp"
#include "flow/limits.hpp"
#include "flow/momentum.hpp"
#include "flow/super_time_stepping.hpp"
#include "grid/domain.hpp"
#include "membranes/membrane_transport.hpp"
#include "membranes/surface_measures.hpp"
#include "openings/feeders.hpp"
#include "openings/outlet_loads.hpp"
#include "pressure/obstacles.hpp"
#include "rigid/rigid_bodies.hpp"
#include "rigid/rigid_impulse.hpp"
#include "solids/interface.hpp"
#include "solids/solid_transport.hpp"
#include "solver/method.hpp"
#include "solver/state.hpp"

#include <functional>
#include <map>
#include <memory>

namespace eulastic {

struct SolverSpec : Method {
  Fluid fluid;
  BoxSides sides;
};

class Solver {
public:
  /// What a scene has.
  struct Parts {
    bool open = false, bodies = false, surface_tension = false, membranes = false, rigid = false;
  };
  /// Fields of the work space that the method needs for it.
  static int work_fields(const Method &method, int dimension, const Parts &parts);
  /// Whether a step begins with the pressure expected in its middle, rather than with that of the last one. `travel`:
  /// rigid bodies do.
  static bool expects_pressure(const Method &method, const ViscosityContrast &contrast, bool travel);
  /// Allocates velocity and pressure on `grid` (all zero) and the work space of the method.
  PetscErrorCode create(const Domain &domain, const SolverSpec &spec);

  const Domain &domain() const { return *domain_; }
  const SolverSpec &spec() const { return spec_; }
  GhostExchange &exchange() { return *exchange_; }
  State &state() { return now_; }
  BodyTracker &bodies() { return bodies_; }
  const State &state() const { return now_; }

  /// Before prepare(); null or without bodies where nothing is rigid. Collective.
  PetscErrorCode set_rigid(std::unique_ptr<RigidBodies> bodies);
  /// Adds a body of a species, whose phase is `boxed` and empty, to this rank: `phase` has material, phi and B on `box`
  /// (boxes/free_bodies.hpp).
  PetscErrorCode add_body(int number, int species, const Box &box, Phase &&phase);
  /// Takes the labelled bodies of a species, whose phase is `boxed`, off the grid. Collective, before prepare().
  PetscErrorCode box_bodies(int species);
  /// Whether any species has its bodies in boxes of their own.
  bool has_boxed() const;
  const FreeBodies &boxed() const { return *boxed_; }
  /// Adds a body that FreeBodies::packed() has made to this rank.
  PetscErrorCode add_packed_body(const std::vector<double> &packed);
  /// Those of this rank, as they are, without velocity.
  std::vector<BodyInBox> boxed_bodies() const { return boxed_->list(); }
  /// Takes away those of all ranks; others are added then.
  void clear_boxed_bodies() { boxed_->clear(); }
  /// Makes ghosts, B outside the bodies and active segments consistent; call after the initial fields are set.
  PetscErrorCode prepare();
  /// Instead of changing anything: makes ghosts and active segments from a state that was read. prepare() has run
  /// before, on a scene with the same phases.
  PetscErrorCode resume(long stages, long sweeps);
  /// For membranes, from the strain that they have: after resume() on a state that had none.
  PetscErrorCode place_markers();
  /// Those of a state that was read, each on any rank.
  PetscErrorCode set_markers(const std::vector<SurfaceMarker> &markers);
  /// Measures the flow: time step limits, WENO5's velocity scale.
  PetscErrorCode measure(FlowExtremes *extremes);
  TimeStepLimits limits(const FlowExtremes &extremes) const;
  /// Kinematic viscosities (flow/viscosity.hpp) at the time of the velocity, until the next step; null where all are
  /// the fluid's.
  PetscErrorCode viscosity_now(const Field **viscosity);
  /// Energy of the surfaces at the time of the velocity and what the flow gives to it; zero without surface tension and
  /// membranes. `bodies`: what is known of the surface of every body, if there are labels and membranes.
  PetscErrorCode surface_energy(SurfaceEnergy *measured, std::vector<SurfaceMeasure> *bodies = nullptr);
  /// What stretch forces do on the flow, at the time of the velocity.
  PetscErrorCode stretch_power(double *power);
  /// Null where nothing is rigid.
  const RigidFaces *rigid() const { return rigid_ ? &rigid_->faces() : nullptr; }
  /// Sides with profiles that know the bodies; before prepare().
  void set_profiles(const BoxSides &sides) { spec_.sides = sides; }
  /// What the fluid has exerted on every rigid body in the last step, in the order of the bodies; before the first one,
  /// what the state says. Where bodies travel it costs as much as the rate of momentum.
  PetscErrorCode rigid_loads(std::vector<RigidLoad> *loads);
  /// Whether loads cannot be told from the state; then they are set before resume().
  bool keeps_rigid_loads() const { return rigid_impulse_ != nullptr; }
  void set_rigid_loads(std::vector<RigidLoad> loads);
  /// Adds to a dissipation by viscosity, as compact differences between faces have it, what surfaces of rigid bodies
  /// change in it. Collective.
  PetscErrorCode add_rigid_dissipation(double *dissipation);
  /// Mends or forgets B where the grid does not resolve it. A part of the method: for what measure() found, before the
  /// step.
  PetscErrorCode forget_unresolved(const FlowExtremes &extremes);
  /// Bytes of all fields of this rank, work space included.
  std::size_t bytes() const;
  using Look = std::function<PetscErrorCode()>;
  /// Advances by dt. `in_middle` is called with the velocity of the start and, with the staggered integrator, phases of
  /// the middle; weighed by the lengths of this step and the last, what it sees and what look_behind() has seen give
  /// what belongs to the time of that velocity, to second order. `with_pressure` is called later, with the velocity of
  /// the start and the pressure of the middle: the same holds for what depends on these alone.
  PetscErrorCode step(double dt, const Look &in_middle = {}, const Look &with_pressure = {});
  /// Calls look() with phases_now() half a step behind, as they are; state and time are not touched. Only where
  /// is_behind().
  PetscErrorCode look_behind(const Look &look);
  bool is_behind() const { return spec_.staggered() && now_.step > 0; }

  /// The phases at the time of the velocity. With the staggered integrator they live half a step behind: a copy is
  /// brought up, the state is not touched. Valid until the next step.
  PetscErrorCode phases_now(const std::vector<Phase> **phases);
  /// Bodies of this rank in boxes of their own, with the velocity, at its time, as phases_now(). Valid until the next
  /// step. Collective.
  PetscErrorCode bodies_now(std::vector<BodyInBox> *bodies);
  /// Calls look(phases) with phases_now() where species whose bodies lie in boxes have them on the grid: phi is the
  /// sum, B and the label are of the body that fills most. Collective.
  PetscErrorCode with_bodies_on_grid(const std::function<PetscErrorCode(const std::vector<Phase> &)> &look);
  /// Calls look() for each of `times` within the last step, with velocity and phases of that time, to second order;
  /// pressure is that of the step. The state is then what it was. Only with the staggered integrator, after step() and
  /// before phases_now().
  PetscErrorCode look_back(const std::vector<double> &times, const Look &look);
  /// One line if rigid bodies touch that should not, or if a body is at a side that volume crosses and cannot leave.
  const std::string &crowded() const { return crowded_; }
  /// Viscous stages and pressure sweeps since the start.
  long stages() const { return stages_; }
  long sweeps() const { return sweeps_before_ + pressure_solver_->sweeps(); }
  double sound_speed() const { return pressure_solver_->sound_speed(); }
  /// What the pressure solver remembers of earlier steps, or null.
  Field *pressure_memory() { return pressure_solver_->memory(); }
  void clear_pressure_memory() { pressure_solver_->clear_memory(); }
  /// The sides with the pressures that loads have now.
  BoxSides sides_now() const { return loads_ ? loads_->with_pressures(spec_.sides) : spec_.sides; }
  /// Of stretches that feed inflow sides, or null.
  Feeders *feeders() { return feeders_.get(); }
  /// Of what is behind pressure sides, or null.
  OutletLoads *loads() { return loads_.get(); }

private:
  PetscErrorCode update_velocity_ghosts(Field &velocity, double time, int width);
  PetscErrorCode update_centre_ghosts(Field &field, int width);
  PhasePlace place_of_phases() { return {domain_, &spec_.sides, exchange_.get()}; }
  double speed_scale(double dt) const;
  /// With the force that differences of given pressures are to a fluid at rest.
  Fluid driven_fluid() const;
  /// Makes the flow at the start pass through the sides as it is given there and, if there is no pressure yet, finds
  /// the one that goes with it, but for forces of bodies.
  PetscErrorCode start_flow();
  PetscErrorCode project_start(bool is_rate, Field &velocity, Field &pressure);
  /// Viscosities, and with the largest tr B of every phase what they mean for the time step.
  ViscosityContrast contrast(const std::vector<double> &trace) const;
  /// Of the rotational update of p: the factor of D*, and that of the place's viscosity times D*.
  struct Rotation {
    double uniform = 0, local = 0;
  };
  Rotation rotation() const;
  bool expects_pressure() const;
  void expect_pressure(double dt);
  EvolveRule evolve_rule(const Material &material) const;
  bool drifts() const;  ///< no wall holds the fluid
  PetscErrorCode transport_to_middle(double dt);
  PetscErrorCode predict(double dt);
  PetscErrorCode predict_explicitly(const Fluid &fluid, const MomentumStep &step);
  PetscErrorCode predict_in_stages(const Fluid &fluid, const MomentumStep &step);
  PetscErrorCode add_local_viscous_force(double scale, Field &to);
  /// Forces per volume on bodies of the grid, to each target as many times as it says.
  PetscErrorCode add_stretch_forces(Field &&scratch, const std::vector<WeightedTarget> &targets);
  PetscErrorCode project(double dt);
  /// Those that travel go to where they are at the end of a step of dt to `time`; their surfaces are those of its
  /// middle.
  PetscErrorCode move_rigid(double time, double dt);
  PetscErrorCode start_rigid_loads();
  /// phi and labels of phases of rigid bodies that travel.
  PetscErrorCode fill_rigid(double time, std::vector<Phase> *phases);
  /// After correct_velocity(): cut faces have their part of the increment, those inside rigid bodies their velocity.
  void respect_rigid(double time, double dt, const Field &increment, Field &velocity) const;
  PetscErrorCode transport(std::vector<Phase> &phases, double dt);
  PetscErrorCode transport_left_cauchy_green(Phase &phase, const ActiveSegments &before, double dt,
                                             const OccupiedRows *rows);
  PetscErrorCode follow_bodies(double dt);
  PetscErrorCode check_sides(bool start);
  PetscErrorCode take_out_bodies(bool whole);
  PetscErrorCode take_out_boxed(const std::vector<std::size_t> &leaving);
  PetscErrorCode feed_bodies();
  /// The same of bodies in boxes that have left their feeders.
  PetscErrorCode feed_boxed(const std::vector<int> &labels);
  /// What becomes of a body that has left its feeder, as far as a rank knows: all others say has_left.
  enum class Coming : int { has_left, waits, comes_in };
  PetscErrorCode find_coming(const std::vector<int> &labels, std::vector<Coming> *states);
  /// Solid fraction of all bodies together, on the grid.
  PetscErrorCode sum_fractions(Field *sum);
  PetscErrorCode find_responses();
  /// Volume that leaves through loaded sides per time.
  PetscErrorCode measure_loads(const Field &velocity, std::vector<double> *flow);
  /// Pressures on loaded sides for a step, and after it with what the flow has become.
  PetscErrorCode begin_loads(double dt);
  PetscErrorCode settle_loads(double dt, const Field &divergence, Field &increment);
  PetscErrorCode show_bodies();
  PetscErrorCode show_fractions(const std::vector<BodyInBox> &bodies, std::vector<Phase> *phases);
  /// `rigid`: phases of bodies that do not travel.
  PetscErrorCode start_boxed_surfaces(const std::vector<const Phase *> &rigid);
  /// Hands bodies to ranks that have less to do. Collective.
  PetscErrorCode share_bodies();
  void forget_looks();
  PetscErrorCode settle(Phase &phase);
  PetscErrorCode find_rows(Phase &phase);
  Field idle_tensor(int components);  ///< work space between the steps

  const Domain *domain_ = nullptr;
  SolverSpec spec_;
  std::unique_ptr<GhostExchange> exchange_;
  std::unique_ptr<PressureSolver> pressure_solver_;
  State now_;
  BodyTracker bodies_;
  std::string crowded_;
  Field velocity_star_, next_fraction_;
  Field next_tensor_;       ///< Euler
  OccupiedRows next_rows_;  ///< of the phase that next_fraction_ and next_tensor_ were swapped out of
  ActiveSegments stale_;    ///< Euler: where next_tensor_ may differ from I
  std::unique_ptr<WorkSpace> work_;
  Field flow_;   ///< with linear_force(): this velocity, the slope, the next velocity; or the other way round
  Field slope_;  ///< of the elastic force in time
  std::unique_ptr<Feeders> feeders_;    ///< null where no side has one
  std::unique_ptr<OutletLoads> loads_;  ///< null where no side has one
  LocalViscosity viscosity_;            ///< of the step, where bodies have their own; else empty
  SolidTransport solids_;
  InterfaceTransport interface_;
  std::unique_ptr<FreeBodies> boxed_;                ///< bodies in boxes; null where no phase is `boxed`
  std::unique_ptr<SurfaceTension> surface_tension_;  ///< null where no species has any
  std::unique_ptr<MembraneTransport> membranes_;     ///< the same of membranes
  std::unique_ptr<RigidBodies> rigid_;               ///< the same of rigid bodies
  std::unique_ptr<RigidImpulse> rigid_impulse_;      ///< null where nothing is rigid
  std::vector<RigidLoad> rigid_loads_;               ///< of a step, if rigid_impulse_
  std::int64_t rigid_loads_step_ = -1;
  ObstacleSolver *obstacles_ = nullptr;  ///< pressure_solver_, if it sees them
  std::vector<Phase> phases_now_;        ///< copies for phases_now(), the first one's B an idle_tensor()
  std::int64_t phases_now_step_ = -1;
  std::vector<BodyInBox> bodies_now_;    ///< for bodies_now()
  bool bodies_are_known_ = false;        ///< these are of this time
  std::map<int, Phase> shown_;           ///< for with_bodies_on_grid(), by species; empty: not made yet
  double looks_back_ = 0;                ///< before the end of the step
  bool as_they_are_ = false;             ///< phases_now(), see look_behind()
  long stages_ = 0, sweeps_before_ = 0;  ///< the latter: before a restart
};

}  // namespace eulastic
