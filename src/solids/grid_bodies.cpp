#include "solids/grid_bodies.hpp"

#include "field/law.hpp"
#include "parts/state.hpp"
#include "solids/transport.hpp"
#include "solids/unresolved.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace eulastic {
namespace {

// Rows whose ghosts must be updated after the transport of a phase: its own rows and, if its fields were swapped, those
// of the fields it received, which may have belonged to another phase.
struct MovedRows {
  bool swaps = false;
  OccupiedRows swapped_in, joined;
  void join(const OccupiedRows &rows) {
    joined = rows;
    if (swaps && !swapped_in.inside()) joined.join(swapped_in);
  }
};

// Rigid bodies do not move on the grid, and other bodies may be in boxes of their own.
bool moves_on_grid(const Phase &phase) { return !phase.material.is_rigid() && !phase.boxed; }

}  // namespace

EvolveRule evolve_rule(const Flow &flow, const Material &material) {
  if (material.is_membrane()) return around_membranes;
  if (!material.elastic()) return {};
  const Domain &domain = flow.domain;
  const bool reset = flow.spec.exterior == SolidExterior::identity;
  const bool linear =
      material.anchored && damps_short_waves(domain.spacing(), domain.dimension(), flow.fluid, material);
  EvolveRule rule = reset ? reset_below_one_per_cent : linear ? evolve_where_full : evolve_above_half;
  // The stress is that of the start of the step, and vanishes at centres where B is I, unless the law reads B of the
  // edges around.
  const bool edges = with_law(material, [](const auto &law) { return law.couples_edges; });
  if (!flow.staggered() && !edges) rule.reach = 1;
  if (!reset && flow.spec.interface == InterfaceScheme::weno5)
    rule.stressed = EvolveRule::everywhere;  // phi is smeared over the grid, with negative values
  // In cut cells B of a free body follows the velocity of the mixture, so it is not that of the solid alone.
  const bool alone = linear || material.viscosity < flow.fluid.viscosity;
  if (!reset && material.viscosity > 0 && alone) rule.viscosity_excess = material.viscosity / flow.fluid.viscosity - 1;
  return rule;
}

int GridBodies::work_fields(const Method &method, int dimension) {
  const int tensor = method.staggered() ? static_cast<int>(tensor_components(dimension).size()) : 0;
  return std::max(tensor, method.interface == InterfaceScheme::plic ? InterfaceTransport::work_fields : 0);
}

double GridBodies::fields(const Method &method, int dimension, bool elastic) {
  const bool tensor = elastic && !method.staggered(), fraction = method.interface == InterfaceScheme::weno5;
  return fraction + (tensor ? static_cast<int>(tensor_components(dimension).size()) : 0);
}

std::size_t GridBodies::bytes() const {
  std::size_t sum = flow_.next_fraction.bytes() + flow_.next_tensor.bytes();
  for (const Phase &phase : flow_.now.phases) sum += phase.bytes();
  return sum;
}

PetscErrorCode GridBodies::carry(CarriedState *state) {
  PetscFunctionBeginUser;
  for (Phase &phase : flow_.now.phases) {
    if (phase.boxed) continue;
    const std::string species = "_" + phase.species;
    state->add_centred("solid_fraction" + species, phase.fraction);
    for (int c = 0; c < phase.tensor.field.count(); ++c) {
      const TensorComponent &component = phase.tensor.components()[c];
      state->fields.push_back({"left_cauchy_green_" + component.name() + species, component.at, phase.tensor.field[c]});
    }
    if (phase.label) state->fields.push_back({"body" + species, at_centre, phase.label[0], Stored::int32});
  }
  PetscFunctionReturn(0);
}

PetscErrorCode GridBodies::start() {
  const Domain &domain = flow_.domain;
  std::vector<Phase> &phases = flow_.now.phases;
  PetscFunctionBeginUser;
  if (!flow_.staggered() &&
      std::any_of(phases.begin(), phases.end(), [](const Phase &phase) { return phase.material.elastic(); }))
    flow_.next_tensor = undeformed_tensor(domain);
  if (flow_.spec.interface != InterfaceScheme::plic) flow_.next_fraction = Field::on_demand(domain, 1);
  for (Phase &phase : phases) {
    phase.tensor.rule = evolve_rule(flow_, phase.material);
    PetscCall(flow_.rebuild_derived_fields(&phase));
  }
  next_rows_ = phases[0].rows;  // an upper bound: the blocks themselves hold their default
  stale_.build(domain, phases[0].fraction[0], phases[0].rows, HUGE_VAL, 0, 0);
  PetscFunctionReturn(0);
}

PetscErrorCode GridBodies::resume() {
  PetscFunctionBeginUser;
  for (Phase &phase : flow_.now.phases) {
    PetscCall(flow_.find_rows(&phase));
    PetscCall(find_solid(flow_.domain, phase));
    if (!phase.boxed && phase.material.elastic())
      PetscCall(flow_.phase_domain().update_ghosts(phase.tensor.field, Box::stencil_width, &phase.rows));
  }
  PetscFunctionReturn(0);
}

PetscErrorCode GridBodies::rebuild_derived_fields(Phase *phase) {
  PetscFunctionBeginUser;
  const OccupiedRows before = phase->rows;
  PetscCall(flow_.find_rows(phase));
  if (!phase->boxed && !phase->material.is_membrane()) PetscCall(reset_exterior(flow_.domain, before, *phase));
  PetscCall(find_solid(flow_.domain, *phase));
  if (phase->boxed || !phase->material.elastic()) PetscFunctionReturn(0);
  const PhaseDomain place = flow_.phase_domain();
  PetscCall(solids_.find_layers(flow_.domain, *phase));
  PetscCall(solids_.extend(place, *phase, phase->tensor.field, &phase->rows));
  PetscCall(place.update_ghosts(phase->tensor.field, Box::stencil_width, &phase->rows));
  PetscFunctionReturn(0);
}

PetscErrorCode GridBodies::reset_unresolved(const std::vector<double> &trace) {
  PetscFunctionBeginUser;
  for (std::size_t p = 0; p < flow_.now.phases.size(); ++p) {
    Phase &phase = flow_.now.phases[p];
    long count = 0;
    if (!phase.material.elastic() || phase.boxed) continue;
    PetscCall(find_and_repair(flow_.domain, trace[p], phase, &count));
    flow_.now.forgotten += count;
    if (count > 0) PetscCall(flow_.rebuild_derived_fields(&phase));
  }
  PetscFunctionReturn(0);
}

// Advances (4) of all phases, then (5) of the elastic ones.
PetscErrorCode GridBodies::move(double dt, std::vector<Phase> *moved_phases) {
  std::vector<Phase> &phases = *moved_phases;
  const Domain &domain = flow_.domain;
  const Field &velocity = flow_.now.velocity;
  const int ghosts = domain.spec().ghosts;
  const bool plic = flow_.spec.interface == InterfaceScheme::plic;
  std::vector<MovedRows> rows(phases.size());
  PetscFunctionBeginUser;
  for (std::size_t p = 0; p < phases.size(); ++p) {
    Phase &phase = phases[p];
    if (!moves_on_grid(phase)) continue;
    if ((rows[p].swaps = !plic)) {
      rows[p].swapped_in = next_rows_;
      if (phase.material.elastic())
        next_rows_ = phase.rows;
      else
        next_rows_.join(phase.rows);  // its B is not swapped
    }
    if (plic) {
      WorkSpace::Lease fluxes;
      PetscCall(flow_.work.lease("fluxes of the interface", InterfaceTransport::work_fields, &fluxes));
      PetscCall(interface_.advance(domain, dt, velocity, static_cast<long>(flow_.now.step), phase.rows, phase.fraction,
                                   fluxes.fields()));
    } else {
      PetscCall(advect_fraction(domain, dt, velocity, phase, rows[p].swapped_in, flow_.next_fraction));
      phase.fraction.swap(flow_.next_fraction);
    }
    rows[p].join(phase.rows);  // the body has moved by less than a cell
  }
  std::vector<OccupiedRows::Transported> moved;
  std::vector<GhostUpdate> fractions, tensors;
  for (std::size_t p = 0; p < phases.size(); ++p)
    if (moves_on_grid(phases[p])) {
      fractions.push_back({&phases[p].fraction, ghosts, &rows[p].joined});
      moved.push_back({&phases[p].rows, std::as_const(phases[p]).fraction[0]});
    }
  PetscCall(flow_.exchange.update_ghosts(fractions));
  PetscCall(OccupiedRows::update(domain, moved));  // also finds what has entered the ghosts of idle rows
  for (std::size_t p = 0; p < phases.size(); ++p) {
    Phase &phase = phases[p];
    if (!moves_on_grid(phase)) continue;
    rows[p].join(phase.rows);
    fill_wall_ghosts_even(domain, at_centre, phase.fraction[0], ghosts, &rows[p].joined);
    if (!phase.material.carries_tensor()) continue;
    const ActiveSegments before = std::move(phase.tensor.strained);
    PetscCall(find_solid(domain, phase));
    if (phase.material.is_membrane()) continue;  // MembraneTransport moves its tensor
    PetscCall(solids_.find_layers(domain, phase));
    PetscCall(transport_left_cauchy_green(phase, before, dt, &rows[p].joined));
    tensors.push_back({&phase.tensor.field, Box::stencil_width, &rows[p].joined});
  }
  PetscCall(flow_.exchange.update_ghosts(tensors));
  for (const GhostUpdate &B : tensors) fill_wall_ghosts_tensor(domain, flow_.spec.sides, *B.field, B.width, B.rows);
  PetscFunctionReturn(0);
}

// Advances B: with the fast method by Heun with the velocity of the middle of the step; with plain Euler by the new
// velocity, because the old one would require dt <= mu/G. `before`: where B of the phase differed from I; points
// outside it keep I. Does not update ghosts.
PetscErrorCode GridBodies::transport_left_cauchy_green(Phase &phase, const ActiveSegments &before, double dt,
                                                       const OccupiedRows *rows) {
  const PhaseDomain place = flow_.phase_domain();
  const Field &velocity = flow_.now.velocity;
  PetscFunctionBeginUser;
  if (flow_.staggered()) {
    WorkSpace::Lease stage;
    PetscCall(flow_.work.lease("first stage of B", phase.tensor.field.count(), &stage));
    PetscCall(solids_.advance(place, {dt, flow_.now.step, flow_.fluid, velocity, before}, rows, phase, stage.fields()));
  } else {
    PetscCall(
        transport_tensor(flow_.domain, {dt, false, &stale_}, velocity, phase, phase.tensor.field, flow_.next_tensor));
    phase.tensor.field.swap(flow_.next_tensor);
    stale_ = before;
    PetscCall(solids_.extend(place, phase, phase.tensor.field, rows));
  }
  PetscFunctionReturn(0);
}

}  // namespace eulastic
