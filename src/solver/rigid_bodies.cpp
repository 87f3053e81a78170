// Solver: rigid bodies: where they are, their part in the projection, and what the fluid exerts on them.
#include "base/events.hpp"
#include "pressure/acm_sweeps.hpp"
#include "solver/solver.hpp"

namespace eulastic {

// Artificial compressibility needs no more than the velocity of the bodies; what solves for the increment has to know
// which faces are closed. Increments of steps before are of no use to it.
PetscErrorCode Solver::set_rigid(std::unique_ptr<RigidBodies> bodies) {
  PetscFunctionBeginUser;
  rigid_ = std::move(bodies);
  if (rigid_ && !rigid_->exist()) rigid_.reset();
  if (rigid_) PetscCall(rigid_->place(now_.time, now_.time));
  if (!rigid_ || spec_.acm_of_the_paper()) PetscFunctionReturn(0);
  PetscCall(work_->reserve(work_fields(spec_, domain_->dimension(), {domain_->any_open(), false, false, false, true})));
  if (spec_.pressure == PressureKind::acm) {
    auto sweeps = std::make_unique<AcmSweepSolver>();
    PetscCall(sweeps->create(*domain_, *exchange_, {spec_.acm_sweeps_max, 0, spec_.acm_coarse}, *work_));
    pressure_solver_ = std::move(sweeps);
  }
  const double accuracy = spec_.pressure == PressureKind::acm ? 1 : 1e-6;
  auto obstacles = std::make_unique<ObstacleSolver>(*domain_, *exchange_, *work_, rigid_->faces(), accuracy,
                                                    spec_.acm_memory, std::move(pressure_solver_));
  obstacles_ = obstacles.get();
  pressure_solver_ = std::move(obstacles);
  PetscFunctionReturn(0);
}

PetscErrorCode Solver::move_rigid(double time, double dt) {
  PetscFunctionBeginUser;
  if (!rigid_ || !rigid_->travel()) PetscFunctionReturn(0);
  VerbScope scope(Verb::rigid);
  PetscCall(rigid_->place(time, time - 0.5 * dt));
  if (obstacles_) obstacles_->follow(rigid_->faces());
  PetscFunctionReturn(0);
}

PetscErrorCode Solver::fill_rigid(double time, std::vector<Phase> *phases) {
  PetscFunctionBeginUser;
  if (!rigid_ || !rigid_->travel()) PetscFunctionReturn(0);
  PetscCall(rigid_->fill(time, phases));
  for (Phase &phase : *phases)
    if (rigid_->travels(phase)) PetscCall(find_rows(phase));
  PetscFunctionReturn(0);
}

void Solver::respect_rigid(double time, double dt, const Field &increment, Field &velocity) const {
  if (!rigid_) return;
  if (!spec_.acm_of_the_paper())
    correct_cut_faces(*domain_, rigid_->faces(), dt / spec_.fluid.density, increment, velocity);
  impose_rigid_motion(*domain_, rigid_->faces(), time, velocity);
}

// From the state alone, until a step says more.
PetscErrorCode Solver::start_rigid_loads() {
  PetscFunctionBeginUser;
  if (!rigid_) PetscFunctionReturn(0);
  PetscCall(rigid_->measure_gaps(now_.phases));
  rigid_impulse_ = std::make_unique<RigidImpulse>(*domain_, rigid_->faces(), spec_.fluid);
  rigid_impulse_->begin(now_.time, 0, now_.time, now_.velocity);
  rigid_impulse_->set_pressure(now_.pressure);
  PetscFunctionReturn(0);
}

void Solver::set_rigid_loads(std::vector<RigidLoad> loads) {
  rigid_loads_ = std::move(loads);
  rigid_loads_step_ = now_.step;
}

PetscErrorCode Solver::rigid_loads(std::vector<RigidLoad> *loads) {
  PetscFunctionBeginUser;
  loads->clear();
  if (!rigid_) PetscFunctionReturn(0);
  if (rigid_loads_step_ != now_.step) PetscCall(rigid_impulse_->measure(&rigid_loads_));
  rigid_loads_step_ = now_.step;
  *loads = rigid_loads_;
  PetscFunctionReturn(0);
}

PetscErrorCode Solver::add_rigid_dissipation(double *dissipation) {
  PetscFunctionBeginUser;
  if (!rigid_) PetscFunctionReturn(0);
  double beside_surfaces = 0;
  PetscCall(
      measure_rigid_dissipation(*domain_, rigid_->faces(), spec_.fluid, now_.time, now_.velocity, &beside_surfaces));
  *dissipation += beside_surfaces;
  PetscFunctionReturn(0);
}

}  // namespace eulastic
