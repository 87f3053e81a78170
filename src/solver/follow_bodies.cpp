// Solver: what is done for bodies before and between the steps: phases whose cells are set, phases at the time of the
// velocity, labels.
#include "bodies/labels.hpp"
#include "physics/transport.hpp"
#include "physics/unresolved.hpp"
#include "solver/solver.hpp"

namespace eulastic {

// Ghosts, B outside the bodies and active segments of a phase whose owned cells are set.
PetscErrorCode Solver::settle(Phase &phase) {
  PetscFunctionBeginUser;
  const OccupiedRows before = phase.rows;
  PetscCall(find_rows(phase));
  if (phase.material.is_membrane() || phase.boxed) {
    PetscCall(find_solid(*domain_, phase));
    if (phase.boxed) PetscFunctionReturn(0);
    PetscCall(membranes_->extend(&phase));
    PetscFunctionReturn(0);
  }
  PetscCall(reset_exterior(*domain_, before, phase));
  PetscCall(find_solid(*domain_, phase));
  if (!phase.material.elastic()) PetscFunctionReturn(0);
  PetscCall(solids_.find_layers(*domain_, phase));
  PetscCall(solids_.extend(place_of_phases(), phase, phase.tensor.field, &phase.rows));
  PetscCall(place_of_phases().update_ghosts(phase.tensor.field, Box::stencil_width, &phase.rows));
  PetscFunctionReturn(0);
}

// Ghosts and rows of phi, of which the owned cells are set; rows without any are left at rest. A phase that fills much
// of the grid has nothing to rest from.
PetscErrorCode Solver::find_rows(Phase &phase) {
  PetscFunctionBeginUser;
  constexpr double much = 0.25;
  const int ghosts = domain_->spec().ghosts;
  PetscCall(phase.rows.find(*domain_, phase.fraction[0]));
  PetscCall(exchange_->update_ghosts(phase.fraction, ghosts, &phase.rows));
  PetscCall(phase.rows.find(*domain_, phase.fraction[0]));  // with what others have
  fill_wall_ghosts_even(*domain_, at_centre, phase.fraction[0], ghosts, &phase.rows);
  const Int3 &n = domain_->cells();
  if (double(phase.rows.cells()) > much * n[0] * n[1] * n[2])
    for (Field *block : {&phase.fraction, &phase.tensor.field, &next_fraction_, &next_tensor_})
      if (block != &phase.tensor.field || (phase.material.carries_tensor() && !phase.boxed)) block->leave_rest();
  PetscFunctionReturn(0);
}

PetscErrorCode Solver::forget_unresolved(const FlowExtremes &extremes) {
  PetscFunctionBeginUser;
  for (std::size_t p = 0; p < now_.phases.size(); ++p) {
    long count = 0;
    if (!now_.phases[p].material.elastic() || now_.phases[p].boxed) continue;
    PetscCall(find_and_forget(*domain_, extremes.trace[p], now_.phases[p], &count));
    now_.forgotten += count;
    if (count > 0) PetscCall(settle(now_.phases[p]));
  }
  long count = 0;
  if (has_boxed()) PetscCall(boxed_->forget_unresolved(extremes.trace, &count));
  now_.forgotten += count;
  PetscFunctionReturn(0);
}

// The next velocity and the slope beside it.
Field Solver::idle_tensor(int components) {
  return flow_.part(velocity_star_.data() == flow_.data() ? 0 : domain_->dimension(), components);
}

PetscErrorCode Solver::phases_now(const std::vector<Phase> **phases) {
  PetscFunctionBeginUser;
  *phases = &now_.phases;
  if (!is_behind() || as_they_are_) PetscFunctionReturn(0);
  *phases = &phases_now_;
  if (phases_now_step_ == now_.step) PetscFunctionReturn(0);
  phases_now_.resize(now_.phases.size());
  for (std::size_t p = 0; flow_ && p < phases_now_.size(); ++p)
    if (now_.phases[p].material.carries_tensor()) {
      phases_now_[p].tensor.field = idle_tensor(now_.phases[p].tensor.field.count());
      break;
    }
  for (std::size_t p = 0; p < phases_now_.size(); ++p) phases_now_[p].copy_from(now_.phases[p]);
  PetscCall(transport(phases_now_, 0.5 * now_.dt - looks_back_));
  std::vector<BodyInBox> bodies;
  PetscCall(bodies_now(&bodies));
  PetscCall(show_fractions(bodies, &phases_now_));
  PetscCall(fill_rigid(now_.time, &phases_now_));
  for (Phase &copy : phases_now_)
    if (copy.label) PetscCall(carry_labels(*domain_, *exchange_, &copy));  // cells that the half step has reached
  phases_now_step_ = now_.step;
  PetscFunctionReturn(0);
}

PetscErrorCode Solver::look_behind(const Look &look) {
  PetscFunctionBeginUser;
  // Labels, and rigid bodies that travel, follow on a schedule: for who looks they are brought up in copies.
  phases_now_step_ = -1;
  phases_now_.resize(now_.phases.size());
  const auto swap = [this] {
    forget_looks();
    for (std::size_t p = 0; p < phases_now_.size(); ++p) {
      Phase &phase = now_.phases[p], &copy = phases_now_[p];
      if (phase.label) phase.label.swap(copy.label);
      if (!rigid_ || !rigid_->travels(phase)) continue;
      phase.fraction.swap(copy.fraction);
      std::swap(phase.rows, copy.rows);
    }
    as_they_are_ = !as_they_are_;
  };
  for (std::size_t p = 0; p < phases_now_.size(); ++p) {
    const Phase &phase = now_.phases[p];
    if (phase.label) phases_now_[p].label.copy_from(phase.label);
    if (!rigid_ || !rigid_->travels(phase)) continue;
    phases_now_[p].fraction.copy_from(phase.fraction);
    phases_now_[p].rows = phase.rows;
  }
  swap();
  struct Restore {
    const decltype(swap) &undo;
    ~Restore() { undo(); }
  } const restore{swap};
  PetscCall(fill_rigid(now_.time, &now_.phases));
  for (Phase &phase : now_.phases)
    if (phase.label) PetscCall(label_new_cells(*domain_, *exchange_, &phase));
  PetscCall(look());
  PetscFunctionReturn(0);
}

PetscErrorCode Solver::look_back(const std::vector<double> &times, const Look &look) {
  PetscFunctionBeginUser;
  if (times.empty()) PetscFunctionReturn(0);
  Field begin, end;
  begin.copy_from(velocity_star_);  // project() has swapped them
  end.copy_from(now_.velocity);
  struct Restore {
    Solver *solver;
    const Field &velocity;
    double time;
    ~Restore() {
      solver->now_.velocity.copy_from(velocity);
      solver->now_.time = time;
      solver->looks_back_ = 0;
      solver->phases_now_step_ = -1;
      solver->forget_looks();
    }
  } const restore{this, end, now_.time};
  const std::ptrdiff_t values = end.count() * end.layout().size;
  for (const double time : times) {
    looks_back_ = restore.time - time;
    phases_now_step_ = -1;
    forget_looks();
    now_.time = time;
    const double share = looks_back_ / now_.dt, *from = begin.data(), *to = end.data();
    double *velocity = now_.velocity.data();
    for (std::ptrdiff_t i = 0; i < values; ++i) velocity[i] = to[i] + share * (from[i] - to[i]);
    PetscCall(look());
  }
  PetscFunctionReturn(0);
}

// Labels are carried on a schedule that is part of the run, never because somebody looks. Planes leave no tail that has
// the label before the surface comes: where phases are measured as they are, not in a copy, it is carried in every
// step.
PetscErrorCode Solver::follow_bodies(double dt) {
  const bool measured_as_they_are = !spec_.staggered() && spec_.interface == InterfaceScheme::plic;
  // Cells; below the half that carry_labels() bears, as the speed is some steps old.
  const double allowed = measured_as_they_are ? 0 : 0.3;
  PetscFunctionBeginUser;
  now_.travel += now_.crossing_rate * dt;
  if (bodies_.bodies() == 0 || now_.travel < allowed) PetscFunctionReturn(0);
  PetscCall(fill_rigid(now_.time + dt, &now_.phases));
  for (Phase &phase : now_.phases)
    if (phase.label) PetscCall(carry_labels(*domain_, *exchange_, &phase));
  PetscCall(bodies_.follow(*domain_, now_.phases));
  if (feeders_) PetscCall(feed_bodies());
  if (membranes_) PetscCall(membranes_->follow(&now_.phases, &now_.markers));
  now_.travel = 0;
  PetscFunctionReturn(0);
}

}  // namespace eulastic
