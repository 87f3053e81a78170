#include "rigid/rigid_flow.hpp"

#include "base/events.hpp"
#include "parts/state.hpp"
#include "rigid/rigid_surfaces.hpp"

namespace eulastic {

RigidFlow::RigidFlow(Flow *flow, std::unique_ptr<RigidBodies> bodies) : flow_(*flow), bodies_(std::move(bodies)) {
  flow->rigid = &bodies_->faces();
}

// The single step of the paper's artificial compressibility needs the velocity of the bodies only.
PetscErrorCode RigidFlow::create(std::unique_ptr<PressureSolver> *solver) {
  PetscFunctionBeginUser;
  PetscCall(bodies_->find_faces(flow_.now.time, flow_.now.time));
  if (flow_.spec.is_single_acm_step()) PetscFunctionReturn(0);
  const double accuracy = flow_.spec.pressure == PressureKind::acm ? 1 : 1e-6;
  auto obstacles = std::make_unique<ObstacleSolver>(flow_.domain, flow_.exchange, flow_.work, faces(), accuracy,
                                                    flow_.spec.acm_memory, std::move(*solver));
  obstacles_ = obstacles.get();
  *solver = std::move(obstacles);
  PetscFunctionReturn(0);
}

PetscErrorCode RigidFlow::carry(CarriedState *state) {
  std::vector<RigidLoad> known;
  PetscFunctionBeginUser;
  PetscCall(loads(&known));
  std::vector<double *> &numbers = state->reals["rigid_loads"];  // force, torque and power of each body
  for (RigidLoad &load : loads_) {
    for (double &force : load.force) numbers.push_back(&force);
    for (double &torque : load.torque) numbers.push_back(&torque);
    numbers.push_back(&load.power);
  }
  PetscFunctionReturn(0);
}

PetscErrorCode RigidFlow::move_bodies(double time, double dt) {
  PetscFunctionBeginUser;
  if (!bodies_->travel()) PetscFunctionReturn(0);
  EventScope scope(Event::rigid);
  PetscCall(bodies_->find_faces(time, time - 0.5 * dt));
  if (obstacles_) obstacles_->update_faces(faces());
  PetscFunctionReturn(0);
}

// Sets the loads to those of the state, until a step has been made.
PetscErrorCode RigidFlow::start_loads() {
  PetscFunctionBeginUser;
  PetscCall(bodies_->measure_gaps(flow_.now.phases));
  impulse_ = std::make_unique<RigidImpulse>(flow_.domain, faces(), flow_.fluid);
  flow_.rigid_means = impulse_->means();
  impulse_->begin(flow_.now.time, 0, flow_.now.time, flow_.now.velocity);
  impulse_->set_pressure(flow_.now.pressure);
  PetscFunctionReturn(0);
}

PetscErrorCode RigidFlow::start() {
  PetscFunctionBeginUser;
  PetscCall(end_step());
  PetscCall(start_loads());
  PetscFunctionReturn(0);
}

PetscErrorCode RigidFlow::begin_resume() { return move_bodies(flow_.now.time, flow_.now.dt); }

PetscErrorCode RigidFlow::resume() {
  PetscFunctionBeginUser;
  PetscCall(start_loads());
  loads_step_ = flow_.now.step;
  PetscFunctionReturn(0);
}

PetscErrorCode RigidFlow::prescribe_velocity(double time, Field &velocity) {
  PetscFunctionBeginUser;
  impose_rigid_motion(flow_.domain, faces(), time, velocity);
  PetscFunctionReturn(0);
}

// The pressure of a travelling body in closed cells is not corrected by increments and would grow there.
PetscErrorCode RigidFlow::prepare(double dt) {
  State &now = flow_.now;
  PetscFunctionBeginUser;
  if (obstacles_ && bodies_->travel()) {
    if (now.pressure_before) obstacles_->copy_closed(now.pressure_before, &now.pressure);
    PetscCall(obstacles_->extrapolate_into_closed(now.pressure));
    PetscCall(flow_.update_centre_ghosts(now.pressure, 1));
  }
  PetscCall(move_bodies(now.time + dt, dt));
  PetscFunctionReturn(0);
}

PetscErrorCode RigidFlow::begin_rate(const MomentumStep &step) {
  PetscFunctionBeginUser;
  impulse_->begin(flow_.now.time, step.dt, step.force_time, flow_.now.velocity);
  PetscFunctionReturn(0);
}

PetscErrorCode RigidFlow::add_rate(const MomentumRate &rate) {
  PetscFunctionBeginUser;
  if (flow_.fluid.inertia)
    advect_from_surfaces(flow_.domain, faces(), flow_.now.time, weno_epsilon(rate.step.speed_scale),
                         rate.scale * rate.step.weights.now, flow_.now.velocity, rate.advection, rate.field);
  PetscFunctionReturn(0);
}

PetscErrorCode RigidFlow::close_rate(const MomentumRate &rate) {
  const double viscosity = flow_.fluid.kinematic_viscosity();
  PetscFunctionBeginUser;
  if (flow_.staggered())
    apply_rigid_surfaces(flow_.domain, faces(), viscosity, rate.viscosity_included, flow_.now.time, rate.step.dt,
                         flow_.now.velocity, rate.field, flow_.slope ? &flow_.slope : nullptr);
  else
    apply_rigid_surfaces_euler(flow_.domain, faces(), viscosity, rate.viscosity_included, flow_.now.time, rate.step.dt,
                               flow_.now.velocity, rate.field);
  PetscFunctionReturn(0);
}

PetscErrorCode RigidFlow::constrain(double dt) {
  PetscFunctionBeginUser;
  impulse_->add_prediction(flow_.now.velocity, flow_.velocity_star);
  PetscCall(prescribe_velocity(flow_.now.time + dt, flow_.velocity_star));
  PetscFunctionReturn(0);
}

// The rotational update removes the whole error of a step if the step begins with the extrapolated pressure, else half.
PetscErrorCode RigidFlow::begin_correction(Field &divergence) {
  PetscFunctionBeginUser;
  if (obstacles_ && flow_.staggered())
    PetscCall(obstacles_->scale_divergence(flow_.now.pressure_before ? 1 : 0.5, divergence));
  impulse_->set_pressure(flow_.now.pressure);
  PetscFunctionReturn(0);
}

PetscErrorCode RigidFlow::observe_increment(const Field &increment) {
  PetscFunctionBeginUser;
  impulse_->add_increment(increment, obstacles_ != nullptr);
  PetscFunctionReturn(0);
}

// An increment that is a formula was not passed to observe_increment(); the pressure contains it now.
PetscErrorCode RigidFlow::end_projection(double, const Field &, Field &increment) {
  PetscFunctionBeginUser;
  if (!increment) impulse_->set_pressure(flow_.now.pressure);
  PetscFunctionReturn(0);
}

// Cut faces get their part of the increment, faces inside the velocity of their body.
PetscErrorCode RigidFlow::correct(double time, double dt, const Field &increment, Field &velocity) {
  PetscFunctionBeginUser;
  if (!flow_.spec.is_single_acm_step())
    correct_cut_faces(flow_.domain, faces(), dt / flow_.fluid.density, increment, velocity);
  PetscCall(prescribe_velocity(time, velocity));
  PetscFunctionReturn(0);
}

PetscErrorCode RigidFlow::position_phases(double time, std::vector<Phase> *phases) {
  PetscFunctionBeginUser;
  if (!bodies_->travel()) PetscFunctionReturn(0);
  PetscCall(bodies_->fill(time, phases));
  for (Phase &phase : *phases)
    if (phase.travels) PetscCall(flow_.find_rows(&phase));
  PetscFunctionReturn(0);
}

PetscErrorCode RigidFlow::end_step() {
  PetscFunctionBeginUser;
  if (!bodies_->contact_message().empty()) flow_.stop_reason = bodies_->contact_message();
  PetscFunctionReturn(0);
}

PetscErrorCode RigidFlow::loads(std::vector<RigidLoad> *loads) {
  PetscFunctionBeginUser;
  if (loads_step_ != flow_.now.step) PetscCall(impulse_->measure(&loads_));
  loads_step_ = flow_.now.step;
  *loads = loads_;
  PetscFunctionReturn(0);
}

PetscErrorCode RigidFlow::add_dissipation(double *dissipation) const {
  double beside_surfaces = 0;
  PetscFunctionBeginUser;
  PetscCall(measure_rigid_dissipation(flow_.domain, faces(), flow_.fluid, flow_.now.time, flow_.now.velocity,
                                      &beside_surfaces));
  *dissipation += beside_surfaces;
  PetscFunctionReturn(0);
}

}  // namespace eulastic
