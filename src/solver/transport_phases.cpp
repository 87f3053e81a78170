// Solver: phi and B of all phases from one time to another, (4) and (5).
#include "physics/transport.hpp"
#include "solver/solver.hpp"

#include <utility>

namespace eulastic {
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
