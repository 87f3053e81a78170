// Solver: what is done for bodies before and between the steps: phases whose cells are set, phases at the time of the
// velocity, labels, and the transport of all phases.
#include "bodies/labels.hpp"
#include "solids/transport.hpp"
#include "solids/unresolved.hpp"
#include "solver/solver.hpp"

#include <utility>

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

// phi and B of all phases from one time to another, (4) and (5).

namespace {

// Rows of a phase and, if its fields are swapped, of what they are swapped with, which may be those of another phase:
// ghosts need an exchange, and those behind walls values, if they did in either.
struct MovedRows {
  bool swaps = false;
  OccupiedRows swapped_in, joined;
  void join(const OccupiedRows &rows) {
    joined = rows;
    if (swaps && !swapped_in.inside()) joined.join(swapped_in);
  }
};

// Rigid bodies stay where they are, and others may lie in boxes of their own.
bool moves_on_grid(const Phase &phase) { return !phase.material.is_rigid() && !phase.boxed; }

}  // namespace

// All phases together, so that their ghosts come together.
PetscErrorCode Solver::transport(std::vector<Phase> &phases, double dt) {
  PetscFunctionBeginUser;
  const int ghosts = domain_->spec().ghosts;
  const bool swaps = !spec_.staggered() || spec_.interface != InterfaceScheme::plic;
  std::vector<MovedRows> rows(phases.size());
  if (membranes_) PetscCall(update_velocity_ghosts(now_.velocity, now_.time, MembraneTransport::velocity_ghosts));
  for (std::size_t p = 0; p < phases.size(); ++p) {
    Phase &phase = phases[p];
    if (!moves_on_grid(phase)) continue;
    if ((rows[p].swaps = swaps)) {
      rows[p].swapped_in = next_rows_;
      if (phase.material.elastic())
        next_rows_ = phase.rows;
      else
        next_rows_.join(phase.rows);  // its B is not swapped
    }
    if (spec_.interface == InterfaceScheme::plic) {
      WorkSpace::Lease fluxes;
      PetscCall(work_->take("fluxes of the interface", InterfaceTransport::work_fields, &fluxes));
      PetscCall(interface_.advance(*domain_, dt, now_.velocity, static_cast<long>(now_.step), phase.rows,
                                   phase.fraction, fluxes.fields()));
    } else {
      PetscCall(advect_fraction(*domain_, dt, now_.velocity, phase, rows[p].swapped_in, next_fraction_));  // (4)
      phase.fraction.swap(next_fraction_);
    }
    rows[p].join(phase.rows);  // it has moved less than a cell
  }
  std::vector<OccupiedRows::Moved> moved;
  std::vector<WantedGhosts> fractions, tensors;
  for (std::size_t p = 0; p < phases.size(); ++p)
    if (moves_on_grid(phases[p])) {
      fractions.push_back({&phases[p].fraction, ghosts, &rows[p].joined});
      moved.push_back({&phases[p].rows, std::as_const(phases[p]).fraction[0]});
    }
  PetscCall(exchange_->update_ghosts(fractions));
  PetscCall(OccupiedRows::follow(*domain_, moved));  // sees what has come into ghosts, even of idle rows
  for (std::size_t p = 0; p < phases.size(); ++p) {
    Phase &phase = phases[p];
    if (!moves_on_grid(phase)) continue;
    rows[p].join(phase.rows);
    fill_wall_ghosts_even(*domain_, at_centre, phase.fraction[0], ghosts, &rows[p].joined);
    if (!phase.material.carries_tensor()) continue;
    const ActiveSegments before = std::move(phase.tensor.strained);
    PetscCall(find_solid(*domain_, phase));
    if (phase.material.is_membrane()) continue;  // with the others of its kind
    PetscCall(solids_.find_layers(*domain_, phase));
    PetscCall(transport_left_cauchy_green(phase, before, dt, &rows[p].joined));  // (5)
    tensors.push_back({&phase.tensor.field, Box::stencil_width, &rows[p].joined});
  }
  if (membranes_) {
    MembraneTransport::Memory memory{&now_.markers};
    PetscCall(membranes_->advance(dt, now_.velocity, &phases == &now_.phases ? &memory : nullptr, &phases));
    now_.forgotten += memory.unresolved;
  }
  PetscCall(exchange_->update_ghosts(tensors));
  for (const WantedGhosts &B : tensors) fill_wall_ghosts_tensor(*domain_, spec_.sides, *B.field, B.width, B.rows);
  PetscFunctionReturn(0);
}

// Staggered: Heun with the velocity of the middle. Euler: B follows the new velocity, else dt <= mu/G. `before` is
// where the B of the phase differed from I; what lies outside it stays I untouched. Leaves the ghosts to the caller.
PetscErrorCode Solver::transport_left_cauchy_green(Phase &phase, const ActiveSegments &before, double dt,
                                                   const OccupiedRows *rows) {
  PetscFunctionBeginUser;
  if (spec_.staggered()) {
    WorkSpace::Lease stage;
    PetscCall(work_->take("first stage of B", phase.tensor.field.count(), &stage));
    PetscCall(solids_.advance(place_of_phases(), {dt, now_.step, spec_.fluid, now_.velocity, before}, rows, phase,
                              stage.fields()));
  } else {
    PetscCall(transport_tensor(*domain_, {dt, false, &stale_}, now_.velocity, phase, phase.tensor.field, next_tensor_));
    phase.tensor.field.swap(next_tensor_);
    stale_ = before;
    PetscCall(solids_.extend(place_of_phases(), phase, phase.tensor.field, rows));
  }
  PetscFunctionReturn(0);
}

}  // namespace eulastic
