// Solver: bodies that lie in boxes of their own.
#include "base/deliver.hpp"
#include "bodies/unwrap.hpp"
#include "boxes/share_out.hpp"
#include "solids/transport.hpp"
#include "solver/solver.hpp"

#include <algorithm>
#include <cmath>

namespace eulastic {

bool Solver::has_boxed() const {
  return std::any_of(now_.phases.begin(), now_.phases.end(), [](const Phase &phase) { return phase.boxed; });
}

PetscErrorCode Solver::add_body(int number, int species, const Box &box, Phase &&phase) {
  PetscFunctionBeginUser;
  phase.tensor.rule = evolve_rule(phase.material);
  PetscCall(boxed_->add(number, species, box, std::move(phase)));
  PetscFunctionReturn(0);
}

PetscErrorCode Solver::add_packed_body(const std::vector<double> &packed) {
  PetscFunctionBeginUser;
  PetscCall(boxed_->add_packed(packed, now_.phases[static_cast<int>(packed[1])]));
  PetscFunctionReturn(0);
}

// Every rank has its part of the flow and of the phases on the grid, whatever bodies it gets.
PetscErrorCode Solver::share_bodies() {
  std::vector<BodyShare> bodies;
  std::vector<int> ranks;
  double load = flow_work * double(domain_->cell_count());
  PetscFunctionBeginUser;
  if (!has_boxed()) PetscFunctionReturn(0);
  forget_looks();
  for (const Phase &phase : now_.phases)
    if (!phase.boxed) load += phase_work(phase.material, false) * double(phase.rows.cells());
  for (const BodyInBox &body : boxed_->list()) {
    const Layout &layout = body.box->layout();
    Int3 middle{};
    for (int d = 0; d < 3; ++d) middle[d] = domain_->image(d, layout.begin[d] + layout.cells[d] / 2);
    const double cost = phase_work(body.phase->material, true) * body.box->cell_count();
    bodies.push_back({body.number, domain_->owner(middle[0], middle[1], middle[2]), cost});
  }
  PetscCall(share_out(domain_->comm(), load, bodies, &ranks));
  PetscCall(boxed_->give(ranks, now_.phases));
  PetscCall(boxed_->follow());
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
  phase.tensor.field = tensor_at_rest(box);
  phase.tensor.centred = like.tensor.centred;
  for_points(box.rows(), [&](int i, int j, int k) {
    if (label(i, j, k) == number) phase.fraction[0](i, j, k) = phi(i, j, k);
  });
  const ConstView own = std::as_const(phase).fraction[0];
  for (int c = 0; c < phase.tensor.field.count(); ++c) {
    const TensorComponent &component = phase.tensor.components()[c];
    const Staggering &at = component.at;
    const auto [low_a, low_b] = component.steps(own);
    for (int k = 0; k < box.points_end(2, at[2]); ++k)
      for (int j = 0; j < box.points_end(1, at[1]); ++j)
        for (int i = 0; i < box.points_end(0, at[0]); ++i) {
          const double *here = &own(i, j, k);
          if (here[0] > 0 || here[-low_a] > 0 || here[-low_b] > 0 || here[-low_a - low_b] > 0)
            phase.tensor.field[c](i, j, k) = brought[2 + c](i, j, k);
        }
  }
  return phase;
}

}  // namespace

// References are at the centres of bodies: a body is shorter than the domain.
PetscErrorCode Solver::box_bodies(int species) {
  PetscFunctionBeginUser;
  Phase &phase = now_.phases[species];
  BodyOwners owners;
  std::vector<Int3> references;
  PetscCall(bodies_.connect(*domain_, now_.phases, {}, &owners, &references));
  const auto bodies = static_cast<std::size_t>(owners.owned().size());
  std::array<std::vector<double>, 6> here, ends;  // the last cells from the reference, low and high
  for (int e = 0; e < 6; ++e) here[e].assign(owners.here().size(), -HUGE_VAL), ends[e].assign(bodies, -HUGE_VAL);
  for_points(domain_->rows(), [&](int i, int j, int k) {
    const int slot = owners.slot(static_cast<int>(phase.label[0](i, j, k)) - 1);
    if (slot < 0 || !(phase.fraction[0](i, j, k) > 0)) return;
    const Real3 x = offset(*domain_, references[slot], {i, j, k});
    for (int d = 0; d < 3; ++d) {
      here[2 * d][slot] = std::max(here[2 * d][slot], -x[d]);
      here[2 * d + 1][slot] = std::max(here[2 * d + 1][slot], x[d]);
    }
  });
  for (int e = 0; e < 6; ++e) PetscCall(owners.reduce(1, MPI_MAX, here[e], &ends[e]));
  std::vector<Found> found;
  std::vector<int> ranks;
  PetscCall(bodies_.owned_references(*domain_, &references));
  for (std::size_t b = 0; b < bodies; ++b) {
    if (!(ends[0][b] > -HUGE_VAL)) continue;
    Found &body = found.emplace_back();
    body.number = owners.owned().begin + static_cast<int>(b) + 1;
    const Int3 &at = references[b];
    for (int d = 0; d < 3; ++d) {
      body.begin[d] = at[d] - static_cast<int>(ends[2 * d][b]);
      body.end[d] = at[d] + static_cast<int>(ends[2 * d + 1][b]) + 1;
    }
    ranks.push_back(domain_->owner(domain_->image(0, at[0]), domain_->image(1, at[1]), domain_->image(2, at[2])));
  }
  PetscCall(deliver(domain_->comm(), ranks, &found));
  std::vector<Box> boxes;
  std::vector<BoxExchange::NumberedBox> numbered;
  for (const Found &body : found) {
    Int3 cells{};
    for (int d = 0; d < 3; ++d) cells[d] = body.end[d] - body.begin[d];
    boxes.emplace_back(domain_->domain_shape(), body.begin, cells, domain_->spec().ghosts);
  }
  for (std::size_t n = 0; n < found.size(); ++n) numbered.push_back({&boxes[n], found[n].number});
  const int components = 2 + phase.tensor.field.count();
  Field grid(*domain_, components);
  const std::size_t size = domain_->layout().size;
  std::copy_n(phase.fraction.data(), size, grid.data());
  std::copy_n(phase.label.data(), size, grid.data() + size);
  std::copy_n(phase.tensor.field.data(), (components - 2) * size, grid.data() + 2 * size);
  BoxExchange exchange(*domain_, components);
  PetscCall(exchange.connect(numbered));
  PetscCall(exchange.fetch(grid));
  for (std::size_t n = 0; n < found.size(); ++n) {
    Field all(boxes[n], components);
    exchange.copy_to_box(n, grid, all);
    PetscCall(add_body(found[n].number, species, boxes[n], take_body(boxes[n], phase, found[n].number, all)));
  }
  phase.empty(*domain_, false);
  PetscFunctionReturn(0);
}

PetscErrorCode Solver::bodies_now(std::vector<BodyInBox> *bodies) {
  PetscFunctionBeginUser;
  bodies->clear();
  if (!has_boxed()) PetscFunctionReturn(0);
  if (!bodies_are_known_) {
    const double behind = is_behind() && !as_they_are_ ? 0.5 * now_.dt - looks_back_ : 0;
    PetscCall(boxed_->look({now_.time, behind, now_.step}, now_.velocity, &bodies_now_));
    bodies_are_known_ = true;
  }
  *bodies = bodies_now_;
  PetscFunctionReturn(0);
}

// phi on the grid of species in boxes whose viscosity or force the flow has to know.
PetscErrorCode Solver::show_fractions(const std::vector<BodyInBox> &bodies, std::vector<Phase> *phases) {
  std::map<int, Phase *> shown;
  PetscFunctionBeginUser;
  for (std::size_t p = 0; p < phases->size(); ++p) {
    const Material &material = (*phases)[p].material;
    if ((*phases)[p].boxed &&
        (viscosity_of(material, spec_.fluid) != spec_.fluid.viscosity || material.body_force.acts()))
      shown[static_cast<int>(p)] = &(*phases)[p];
  }
  if (shown.empty()) PetscFunctionReturn(0);
  PetscCall(boxed_->show_fractions(bodies, shown));
  for (const auto &[p, phase] : shown) PetscCall(find_rows(*phase));
  PetscFunctionReturn(0);
}

PetscErrorCode Solver::start_boxed_surfaces(const std::vector<const Phase *> &rigid) {
  bool membranes = false, pulls = false;  // as a whole
  PetscFunctionBeginUser;
  for (const Phase &phase : now_.phases) {
    const Material &material = phase.material;
    if (!phase.boxed) continue;
    membranes = membranes || material.is_membrane();
    pulls = pulls || material.surface_tension > 0 || (material.is_membrane() && material.membrane.bending_modulus > 0);
  }
  if (!membranes && !pulls) PetscFunctionReturn(0);
  boxed_->set_surroundings(drifts() && pulls, membranes ? rigid : std::vector<const Phase *>());
  PetscCall(boxed_->start_membranes());
  PetscFunctionReturn(0);
}

PetscErrorCode Solver::with_bodies_on_grid(const std::function<PetscErrorCode(const std::vector<Phase> &)> &look) {
  const std::vector<Phase> *phases = nullptr;
  PetscFunctionBeginUser;
  PetscCall(phases_now(&phases));
  if (!has_boxed()) {
    PetscCall(look(*phases));
    PetscFunctionReturn(0);
  }
  std::vector<Phase> &all = phases == &now_.phases ? now_.phases : phases_now_;
  if (shown_.empty()) PetscCall(show_bodies());
  const auto swap = [&] {
    for (auto &[species, phase] : shown_) std::swap(all[species], phase);
  };
  swap();
  struct Restore {
    const decltype(swap) &undo;
    ~Restore() { undo(); }
  } const restore{swap};
  PetscCall(look(all));
  PetscFunctionReturn(0);
}

// The phases of species whose bodies lie in boxes, as they would be on the grid.
PetscErrorCode Solver::show_bodies() {
  std::vector<BodyInBox> bodies;
  std::map<int, Phase *> shown;
  PetscFunctionBeginUser;
  PetscCall(bodies_now(&bodies));
  for (std::size_t p = 0; p < now_.phases.size(); ++p) {
    const Phase &of_species = now_.phases[p];
    if (!of_species.boxed) continue;
    Phase &phase = shown_[static_cast<int>(p)];
    phase.species = of_species.species;
    phase.material = of_species.material;
    phase.tensor.rule = of_species.tensor.rule;
    phase.empty(*domain_, true);
    shown[static_cast<int>(p)] = &phase;
  }
  PetscCall(boxed_->show(bodies, shown));
  for (auto &[species, phase] : shown_) {
    PetscCall(find_rows(phase));
    PetscCall(exchange_->update_ghosts(phase.label, 1, &phase.rows));
    PetscCall(find_solid(*domain_, phase));
    PetscCall(place_of_phases().update_ghosts(phase.tensor.field, Box::stencil_width, &phase.rows));
  }
  PetscFunctionReturn(0);
}

void Solver::forget_looks() {
  bodies_are_known_ = false;
  bodies_now_.clear();
  shown_.clear();
}

}  // namespace eulastic
