#include "boxes/boxed_bodies.hpp"

#include "base/send_to_ranks.hpp"
#include "bodies/unwrap.hpp"
#include "boxes/share_out.hpp"
#include "solids/grid_bodies.hpp"
#include "solids/transport.hpp"

#include <algorithm>
#include <cmath>

namespace eulastic {

bool BoxedBodies::exist() const {
  const std::vector<Phase> &phases = flow_.now.phases;
  return std::any_of(phases.begin(), phases.end(), [](const Phase &phase) { return phase.boxed; });
}

PetscErrorCode BoxedBodies::add(int number, int species, const Box &box, Phase &&phase) {
  PetscFunctionBeginUser;
  phase.tensor.rule = evolve_rule(flow_, phase.material);
  PetscCall(bodies_.add(number, species, box, std::move(phase)));
  PetscFunctionReturn(0);
}

PetscErrorCode BoxedBodies::add_packed(const std::vector<double> &packed) {
  return bodies_.add_packed(packed, flow_.now.phases[static_cast<int>(packed[1])]);
}

PetscErrorCode BoxedBodies::add_copies(const std::vector<std::pair<int, int>> &copies,
                                       const std::map<int, Int3> &shifts) {
  PetscFunctionBeginUser;
  for (const auto &[label, copy] : copies)
    PetscCall(bodies_.add_copy(label, copy, shifts.at(label), flow_.now.phases[flow_.bodies.species(label)]));
  PetscFunctionReturn(0);
}

PetscErrorCode BoxedBodies::refit() {
  PetscFunctionBeginUser;
  discard_copies();
  PetscCall(bodies_.follow());
  PetscCall(put_fractions_on_grid(bodies_.list(), &flow_.now.phases));
  PetscFunctionReturn(0);
}

namespace {

// A body on the grid: its box, and the rank that is to have it.
struct Found {
  int number;
  Int3 begin, end;
};

// What a box that has been brought from the grid holds of one of its bodies: phi where that has the label, B where any
// cell of the body lies, I elsewhere.
Phase take_body(const Box &box, const Phase &like, int number, const Field &brought) {
  const ConstView phi = brought[0], label = brought[1];
  Phase phase;
  phase.species = like.species;
  phase.material = like.material;
  phase.fraction = Field(box, 1);
  phase.tensor.field = undeformed_tensor(box);
  phase.tensor.centred = like.tensor.centred;
  for_points(box.rows(), [&](int i, int j, int k) {
    if (label(i, j, k) == number) phase.fraction[0](i, j, k) = phi(i, j, k);
  });
  const ConstView own = std::as_const(phase).fraction[0];
  for (int c = 0; c < phase.tensor.field.count(); ++c) {
    const TensorComponent &component = phase.tensor.components()[c];
    const auto low = component.steps(own);
    for_points(box.points(component.at), [&](int i, int j, int k) {
      const double *here = &own(i, j, k);
      if (here[0] > 0 || here[-low[0]] > 0 || here[-low[1]] > 0 || here[-low[0] - low[1]] > 0)
        phase.tensor.field[c](i, j, k) = brought[2 + c](i, j, k);
    });
  }
  return phase;
}

}  // namespace

// References are at the centres of bodies: a body is shorter than the domain.
PetscErrorCode BoxedBodies::take_from_grid(int species) {
  const Domain &domain = flow_.domain;
  PetscFunctionBeginUser;
  Phase &phase = flow_.now.phases[species];
  BodyOwners owners;
  std::vector<Int3> references;
  PetscCall(flow_.bodies.connect(domain, flow_.now.phases, {}, &owners, &references));
  const auto bodies = static_cast<std::size_t>(owners.owned().size());
  std::array<std::vector<double>, 6> here, ends;  // the last cells from the reference, low and high
  for (int e = 0; e < 6; ++e) here[e].assign(owners.here().size(), -HUGE_VAL), ends[e].assign(bodies, -HUGE_VAL);
  for_points(domain.rows(), [&](int i, int j, int k) {
    const int slot = owners.slot(static_cast<int>(phase.label[0](i, j, k)) - 1);
    if (slot < 0 || !(phase.fraction[0](i, j, k) > 0)) return;
    const Real3 x = offset(domain, references[slot], {i, j, k});
    for (int d = 0; d < 3; ++d) {
      here[2 * d][slot] = std::max(here[2 * d][slot], -x[d]);
      here[2 * d + 1][slot] = std::max(here[2 * d + 1][slot], x[d]);
    }
  });
  for (int e = 0; e < 6; ++e) PetscCall(owners.reduce(1, MPI_MAX, here[e], &ends[e]));
  std::vector<Found> found;
  std::vector<int> ranks;
  PetscCall(flow_.bodies.owned_references(domain, &references));
  for (std::size_t b = 0; b < bodies; ++b) {
    if (!(ends[0][b] > -HUGE_VAL)) continue;
    Found &body = found.emplace_back();
    body.number = owners.owned().begin + static_cast<int>(b) + 1;
    const Int3 &at = references[b];
    for (int d = 0; d < 3; ++d) {
      body.begin[d] = at[d] - static_cast<int>(ends[2 * d][b]);
      body.end[d] = at[d] + static_cast<int>(ends[2 * d + 1][b]) + 1;
    }
    ranks.push_back(domain.owner(domain.image(0, at[0]), domain.image(1, at[1]), domain.image(2, at[2])));
  }
  PetscCall(send_to_ranks(domain.comm(), ranks, &found));
  std::vector<Box> boxes;
  std::vector<BoxExchange::NumberedBox> numbered;
  for (const Found &body : found) {
    Int3 cells{};
    for (int d = 0; d < 3; ++d) cells[d] = body.end[d] - body.begin[d];
    boxes.emplace_back(domain.domain_shape(), body.begin, cells, domain.spec().ghosts);
  }
  for (std::size_t n = 0; n < found.size(); ++n) numbered.push_back({&boxes[n], found[n].number});
  const int components = 2 + phase.tensor.field.count();
  Field grid(domain, components);
  const std::size_t size = domain.layout().size;
  std::copy_n(phase.fraction.data(), size, grid.data());
  std::copy_n(phase.label.data(), size, grid.data() + size);
  std::copy_n(phase.tensor.field.data(), (components - 2) * size, grid.data() + 2 * size);
  BoxExchange exchange(domain, components);
  PetscCall(exchange.connect(numbered));
  PetscCall(exchange.fetch(grid));
  for (std::size_t n = 0; n < found.size(); ++n) {
    Field all(boxes[n], components);
    exchange.copy_to_box(n, grid, all);
    PetscCall(add(found[n].number, species, boxes[n], take_body(boxes[n], phase, found[n].number, all)));
  }
  phase.empty(domain, false);
  PetscFunctionReturn(0);
}

// Where no wall holds the fluid, the net force of surfaces that pull would move all of it.
PetscErrorCode BoxedBodies::start_surfaces() {
  bool membranes = false, pulls = false;
  std::vector<const Phase *> rigid;
  PetscFunctionBeginUser;
  for (const Phase &phase : flow_.now.phases) {
    const Material &material = phase.material;
    if (material.is_rigid() && !phase.travels) rigid.push_back(&phase);
    if (!phase.boxed) continue;
    membranes = membranes || material.is_membrane();
    pulls = pulls || material.surface_tension > 0 || (material.is_membrane() && material.membrane.bending_modulus > 0);
  }
  if (!membranes && !pulls) PetscFunctionReturn(0);
  bodies_.set_surroundings(flow_.drifts() && pulls, membranes ? rigid : std::vector<const Phase *>());
  PetscCall(bodies_.start_membranes());
  PetscFunctionReturn(0);
}

PetscErrorCode BoxedBodies::start() {
  PetscFunctionBeginUser;
  PetscCall(start_surfaces());
  PetscCall(bodies_.place_markers());
  PetscCall(resume());
  PetscFunctionReturn(0);
}

PetscErrorCode BoxedBodies::resume() {
  PetscFunctionBeginUser;
  PetscCall(share());
  PetscCall(put_fractions_on_grid(bodies_.list(), &flow_.now.phases));
  PetscFunctionReturn(0);
}

// Every rank has its part of the flow and of the phases on the grid, whatever bodies it gets.
PetscErrorCode BoxedBodies::share() {
  const Domain &domain = flow_.domain;
  std::vector<BodyShare> bodies;
  std::vector<int> ranks;
  double load = flow_work * double(domain.cell_count());
  PetscFunctionBeginUser;
  if (!exist()) PetscFunctionReturn(0);
  discard_copies();
  for (const Phase &phase : flow_.now.phases)
    if (!phase.boxed) load += phase_work(phase.material, false) * double(phase.rows.cells());
  for (const BodyInBox &body : bodies_.list()) {
    const Layout &layout = body.box->layout();
    Int3 middle{};
    for (int d = 0; d < 3; ++d) middle[d] = domain.image(d, layout.begin[d] + layout.cells[d] / 2);
    const double cost = phase_work(body.phase->material, true) * body.box->cell_count();
    bodies.push_back({body.number, domain.owner(middle[0], middle[1], middle[2]), cost});
  }
  PetscCall(share_out(domain.comm(), load, bodies, &ranks));
  PetscCall(bodies_.give(ranks, flow_.now.phases));
  PetscCall(bodies_.follow());
  PetscFunctionReturn(0);
}

PetscErrorCode BoxedBodies::begin_step() {
  constexpr int shared_every = 100;  // steps: bodies move by some cells meanwhile
  PetscFunctionBeginUser;
  discard_copies();
  if (flow_.now.step > 0 && flow_.now.step % shared_every == 0) PetscCall(share());
  PetscFunctionReturn(0);
}

PetscErrorCode BoxedBodies::begin_slope(double dt, Field &slope) { return bodies_.add_forces({{&slope, -1 / dt}}); }

PetscErrorCode BoxedBodies::move(double dt, std::vector<Phase> *phases) {
  long unresolved = 0;
  PetscFunctionBeginUser;
  if (phases == &flow_.now.phases) {
    PetscCall(bodies_.advance({flow_.now.time, dt, flow_.now.step}, flow_.now.velocity, &unresolved));
    flow_.now.forgotten += unresolved;
    PetscCall(put_fractions_on_grid(bodies_.list(), phases));
  } else {
    std::vector<BodyInBox> bodies;
    PetscCall(synchronise(dt, &bodies));
    PetscCall(put_fractions_on_grid(bodies, phases));
  }
  PetscFunctionReturn(0);
}

PetscErrorCode BoxedBodies::add_rate(const MomentumRate &rate) {
  PetscFunctionBeginUser;
  std::vector<WeightedTarget> targets{{&rate.field, rate.scale}};
  if (rate.slope.field) targets.push_back(rate.slope);
  PetscCall(bodies_.add_forces(targets));
  subtract_mean(flow_.domain, bodies_.mean_force(), rate.field);
  PetscFunctionReturn(0);
}

PetscErrorCode BoxedBodies::add_power(const SynchronisedBodies &bodies, double *power) {
  double own = 0;
  PetscFunctionBeginUser;
  PetscCall(bodies_.stretch_power(bodies.boxed, flow_.now.phases, &own));
  *power += own;
  PetscFunctionReturn(0);
}

PetscErrorCode BoxedBodies::add_surface_energy(const SynchronisedBodies &bodies, SurfaceEnergy *measured,
                                               std::vector<SurfaceSample> *) {
  PetscFunctionBeginUser;
  const std::vector<Phase> &phases = flow_.now.phases;
  if (std::any_of(phases.begin(), phases.end(),
                  [](const Phase &phase) { return phase.boxed && phase.material.has_surface(); }))
    PetscCall(bodies_.measure_surfaces(bodies.boxed, phases, measured, &samples_));
  PetscFunctionReturn(0);
}

PetscErrorCode BoxedBodies::give_surface_measures(const std::vector<BodyInBox> &bodies, int first,
                                                  std::vector<SurfaceMeasure> *owned) const {
  struct Found {
    int number;
    SurfaceMeasure measure;
  };
  std::vector<Found> found;
  std::vector<int> ranks;
  PetscFunctionBeginUser;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    if (!bodies[b].phase->material.is_membrane()) continue;
    found.push_back({bodies[b].number, measure_surface_in_box(bodies[b], samples_[b])});
    ranks.push_back(BodyRange::owner(bodies[b].number - 1, flow_.bodies.bodies(), flow_.domain.ranks()));
  }
  PetscCall(send_to_ranks(flow_.domain.comm(), ranks, &found));
  for (const Found &one : found) (*owned)[one.number - 1 - first] = one.measure;
  PetscFunctionReturn(0);
}

PetscErrorCode BoxedBodies::reset_unresolved(const std::vector<double> &trace) {
  long count = 0;
  PetscFunctionBeginUser;
  PetscCall(bodies_.reset_unresolved(trace, &count));
  flow_.now.forgotten += count;
  PetscFunctionReturn(0);
}

PetscErrorCode BoxedBodies::synchronise(double behind, std::vector<BodyInBox> *bodies) {
  PetscFunctionBeginUser;
  if (exist() && !are_synchronised_) {
    PetscCall(bodies_.synchronise({flow_.now.time, behind, flow_.now.step}, flow_.now.velocity, &synchronised_));
    are_synchronised_ = true;
  }
  *bodies = synchronised_;
  PetscFunctionReturn(0);
}

void BoxedBodies::discard_copies() {
  are_synchronised_ = false;
  synchronised_.clear();
  on_grid_.clear();
}

// phi on the grid of species whose viscosity or force the flow has to know.
PetscErrorCode BoxedBodies::put_fractions_on_grid(const std::vector<BodyInBox> &bodies, std::vector<Phase> *phases) {
  std::map<int, Phase *> targets;
  PetscFunctionBeginUser;
  for (std::size_t p = 0; p < phases->size(); ++p) {
    const Material &material = (*phases)[p].material;
    if ((*phases)[p].boxed &&
        (viscosity_of(material, flow_.fluid) != flow_.fluid.viscosity || material.body_force.acts()))
      targets[static_cast<int>(p)] = &(*phases)[p];
  }
  if (targets.empty()) PetscFunctionReturn(0);
  PetscCall(bodies_.put_fractions_on_grid(bodies, targets));
  for (const auto &[p, phase] : targets) PetscCall(flow_.find_rows(phase));
  PetscFunctionReturn(0);
}

PetscErrorCode BoxedBodies::find_all_fractions(std::map<int, Phase> *phases) {
  std::map<int, Phase *> targets;
  PetscFunctionBeginUser;
  for (std::size_t p = 0; p < flow_.now.phases.size(); ++p) {
    if (!flow_.now.phases[p].boxed) continue;
    Phase &phase = (*phases)[static_cast<int>(p)];
    phase.fraction = Field(flow_.domain, 1);
    targets[static_cast<int>(p)] = &phase;
  }
  PetscCall(bodies_.put_fractions_on_grid(bodies_.list(), targets));
  PetscFunctionReturn(0);
}

PetscErrorCode BoxedBodies::with_bodies_on_grid(const std::vector<BodyInBox> &bodies, std::vector<Phase> *phases,
                                                const std::function<PetscErrorCode()> &observe) {
  PetscFunctionBeginUser;
  if (exist() && on_grid_.empty()) PetscCall(put_on_grid(bodies));
  const auto swap = [&] {
    for (auto &[species, phase] : on_grid_) std::swap((*phases)[species], phase);
  };
  swap();
  struct Restore {
    const decltype(swap) &undo;
    ~Restore() { undo(); }
  } const restore{swap};
  PetscCall(observe());
  PetscFunctionReturn(0);
}

// The phases of species whose bodies lie in boxes, as they would be on the grid.
PetscErrorCode BoxedBodies::put_on_grid(const std::vector<BodyInBox> &bodies) {
  std::map<int, Phase *> targets;
  PetscFunctionBeginUser;
  for (std::size_t p = 0; p < flow_.now.phases.size(); ++p) {
    const Phase &of_species = flow_.now.phases[p];
    if (!of_species.boxed) continue;
    Phase &phase = on_grid_[static_cast<int>(p)];
    phase.species = of_species.species;
    phase.material = of_species.material;
    phase.tensor.rule = of_species.tensor.rule;
    phase.empty(flow_.domain, true);
    targets[static_cast<int>(p)] = &phase;
  }
  PetscCall(bodies_.put_on_grid(bodies, targets));
  for (auto &[species, phase] : on_grid_) {
    PetscCall(flow_.find_rows(&phase));
    PetscCall(flow_.exchange.update_ghosts(phase.label, 1, &phase.rows));
    PetscCall(find_solid(flow_.domain, phase));
    PetscCall(flow_.phase_domain().update_ghosts(phase.tensor.field, Box::stencil_width, &phase.rows));
  }
  PetscFunctionReturn(0);
}

}  // namespace eulastic
