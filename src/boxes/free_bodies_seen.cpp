// FreeBodies: copies of the bodies at the time of the velocity, their measures, and their fields on the grid.
#include "boxes/free_bodies.hpp"

#include "field/boundaries.hpp"
#include "membranes/stretch_force.hpp"

#include <algorithm>
#include <utility>

namespace eulastic {

double FreeBodies::values(const Material &material, int dimension, const Real3 &cells, int ghosts) {
  const int tensor = material.carries_tensor() ? static_cast<int>(tensor_components(dimension).size()) : 0;
  // Layers of points around a body without a surface, on both sides together: those that B is extended to, faces behind
  // them, and a ghost.
  constexpr int seen_around = 2 * ExteriorLayers::layers + 1 + 2;
  double box = 1, around = 1, kept = 1;
  for (int d = 0; d < dimension; ++d) {
    const double own = cells[d] + 2 * margin(material), all = own + 2 * ghosts;
    box *= own;
    around *= all;
    kept *= material.has_surface() ? all : cells[d] + seen_around;
  }
  return around * (1 + tensor) + kept * (1 + tensor + dimension) + box * dimension;
}

// What has a surface is measured in the box of the body. Of other bodies a copy is moved in scratch memory, and its
// cells are kept.
PetscErrorCode FreeBodies::synchronise_body(std::size_t b, const Step &step, const Field &velocity, BodyInBox *result) {
  PetscFunctionBeginUser;
  const Body &body = bodies_[b];
  const Material &material = body.phase.material;
  const int dimension = body.box.dimension(), tensors = body.phase.tensor.field.count();
  const bool has_surface = material.has_surface();
  SynchronisedCopy &own = copies_[b];
  if (step.dt == 0) {
    own.velocity = Field(body.box, dimension);
    bring_velocity(b, step, velocity, &own.velocity);
    result->velocity = &own.velocity;
    PetscFunctionReturn(0);
  }
  const int working = material.is_membrane() ? MembraneMechanics::work_fields : stage_fields(body.phase);
  Field memory = scratch(body.box, dimension + 1 + tensors + working), flow = memory.part(0, dimension),
        work = memory.part(dimension + 1 + tensors, working);
  bring_velocity(b, step, velocity, &flow);
  Phase moved;
  if (!has_surface) moved.fraction = memory.part(dimension, 1);
  if (!has_surface && material.carries_tensor()) moved.tensor.field = memory.part(dimension + 1, tensors);
  moved.copy_from(body.phase);
  PetscCall(move(body.box, step, flow, work, &moved));
  if (material.is_membrane()) {
    MembraneMechanics membrane({&body.box, sides_, nullptr});
    long unresolved = 0;
    PetscCall(membrane.find(moved, work));
    PetscCall(membrane.move(step.dt, flow, {}, &moved, &unresolved));
  }
  if (has_surface) {
    own.box = body.box;
    own.moved = std::move(moved);
    own.velocity.copy_from(flow);
  } else {
    constexpr int around = ExteriorLayers::layers, ghosts = 1;
    const Box block = moved.block(body.box, around, around + 1);
    own.box = Box(block.domain_shape(), block.layout().begin, block.cells(), ghosts);
    own.moved = empty_like(moved, own.box);
    copy_shared(body.box, moved.fraction, 0, &own.moved.fraction);
    if (material.carries_tensor()) copy_shared(body.box, moved.tensor.field, ghosts, &own.moved.tensor.field);
    own.moved.rows.find_in_box(own.box, std::as_const(own.moved).fraction[0], rows_reach(material, ghosts));
    fill_wall_ghosts_even(own.box, at_centre, own.moved.fraction[0], ghosts, &own.moved.rows);
    own.velocity = Field(own.box, dimension);
    copy_shared(body.box, flow, ghosts, &own.velocity);
  }
  result->box = &own.box;
  result->phase = &own.moved;
  result->velocity = &own.velocity;
  PetscFunctionReturn(0);
}

PetscErrorCode FreeBodies::synchronise(const Step &step, const Field &velocity, std::vector<BodyInBox> *bodies) {
  PetscFunctionBeginUser;
  PetscCall(exchange_.fetch(velocity));
  *bodies = list();
  copies_.clear();
  copies_.resize(bodies_.size());
  PetscCall(for_bodies([&](std::size_t b) { return synchronise_body(b, step, velocity, &(*bodies)[b]); }));
  PetscFunctionReturn(0);
}

// Uses the force and the samples that were found with it. They are found again for a copy that has moved, and where the
// force contains that of a stretch force.
PetscErrorCode FreeBodies::measure_membrane(const BodyInBox &moved, const Body &body, ExactSums *sum,
                                            std::vector<SurfaceSample> *samples) {
  PetscFunctionBeginUser;
  const Box &box = body.box;
  const Phase &phase = *moved.phase;
  const int n = box.cells()[0], dimension = box.dimension();
  const bool kept = &phase == &body.phase && !body.surface.empty() && !is_stretched(phase.material);
  SegmentValues found;
  if (kept) {
    *samples = body.surface;
  } else {
    Field all = scratch(box, MembraneMechanics::work_fields + dimension), force = all.part(0, dimension),
          work = all.part(dimension, MembraneMechanics::work_fields);
    MembraneMechanics membrane({&box, sides_, nullptr});
    PetscCall(membrane.find(phase, work));
    PetscCall(membrane_force(membrane, body, phase, false, force, samples));
    found.take(force, phase.tensor.stressed);
  }
  EventScope scope(Event::sums);
  const SegmentValues &force = kept ? body.force : found;
  const ActiveSegments &forced = phase.tensor.stressed;
  std::vector<double> power(n);
  for (const Segment &row : box.rows())
    for (int a = 0; a < dimension && !forced.idle(row.j, row.k); ++a) {
      const double *v = (*moved.velocity)[a].row(row.j, row.k);
      std::fill(power.begin(), power.end(), 0);
      for (const Segment &s : forced.row(row.j, row.k)) {
        const double *f = force.of(a, &s - forced.all().data());
        for (int i = s.i_begin; i < std::min(s.i_end, n); ++i) power[i] = -v[i] * (fluid_.density * f[i - s.i_begin]);
      }
      sum->add_row(MembraneMechanics::power, power.data(), n, box.layout().begin[0]);
    }
  body.film.add_energy(phase, MembraneMechanics::stored, sum);
  MembraneMechanics::add_stored_energy(*samples, box.cell_volume(), sum);
  for (SurfaceSample &sample : *samples) sample.label = moved.number;
  MembraneMechanics::set_velocities(*moved.velocity, samples);
  PetscFunctionReturn(0);
}

PetscErrorCode FreeBodies::measure_surfaces(const std::vector<BodyInBox> &bodies, const std::vector<Phase> &species,
                                            SurfaceEnergy *measured, std::vector<std::vector<SurfaceSample>> *samples) {
  // Of all membranes, then of each species with surface tension.
  constexpr int of_membranes = MembraneMechanics::sums, of_species = CapillaryForce::sums;
  const int count = of_membranes + of_species * static_cast<int>(species.size());
  std::vector<ExactSums> sum(threads(), ExactSums(count));
  PetscFunctionBeginUser;
  samples->assign(bodies.size(), {});
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const BodyInBox &body = bodies[b];
    if (body.phase->material.is_membrane()) PetscCall(measure_membrane(body, bodies_[b], &sum.front(), &(*samples)[b]));
    if (body.phase->material.surface_tension > 0) {
      Field work = scratch(*body.box, CapillaryForce::work_fields);
      CapillaryForce capillary(*body.box, nullptr);
      PetscCall(capillary.find(*body.phase, work));
      capillary.measure(*body.velocity, of_membranes + of_species * body.species, &sum);
    }
  }
  std::vector<double> total(count);
  PetscCall(reduce_parts(domain_->comm(), sum, total.data()));
  const double volume = domain_->cell_volume();
  measured->power += total[MembraneMechanics::power] * volume;
  measured->energy += total[MembraneMechanics::stored] * volume;
  for (std::size_t s = 0; s < species.size(); ++s) {
    const double *own = &total[of_membranes + of_species * s];
    measured->power += own[CapillaryForce::power] * volume;
    measured->energy += species[s].material.surface_tension * own[CapillaryForce::area];
  }
  PetscFunctionReturn(0);
}

PetscErrorCode FreeBodies::stretch_power(const std::vector<BodyInBox> &bodies, const std::vector<Phase> &species,
                                         double *power) {
  PetscFunctionBeginUser;
  *power = 0;
  if (std::none_of(species.begin(), species.end(), [](const Phase &p) { return p.boxed && is_stretched(p.material); }))
    PetscFunctionReturn(0);
  ExactSums sum(1);
  for (const BodyInBox &body : bodies)
    if (is_stretched(body.phase->material))
      StretchedBody(*body.box, *body.phase).add_power((*body.velocity)[0], 0, &sum);
  PetscCall(sum.reduce(domain_->comm(), power));
  *power *= domain_->cell_volume();
  PetscFunctionReturn(0);
}

PetscErrorCode FreeBodies::put_fractions_on_grid(const std::vector<BodyInBox> &bodies,
                                                 const std::map<int, Phase *> &phases) {
  PetscFunctionBeginUser;
  PetscCall(connect_fractions());
  std::vector<ActiveSegments> filled(bodies.size());
  std::vector<SegmentValues> values(bodies.size());
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    constexpr double least = 1e-300;
    if (phases.count(bodies[b].species) == 0) continue;
    const Box &box = bodies_[b].box;  // that the exchange knows
    const auto take = [&](const Field &phi, const OccupiedRows &rows) {
      filled[b].build(box, phi[0], rows, least, 0, 0);
      values[b].take(phi, filled[b]);
    };
    if (bodies[b].phase == &bodies_[b].phase) {
      take(bodies_[b].phase.fraction, bodies_[b].phase.rows);
      continue;
    }
    Field phi = scratch(box, 1);
    phi.fill(0, 0);
    copy_shared(*bodies[b].box, bodies[b].phase->fraction, 0, &phi);
    OccupiedRows rows;
    rows.find_in_box(box, std::as_const(phi)[0], 1);
    take(phi, rows);
  }
  for (const auto &[species, phase] : phases) {
    std::vector<BoxExchange::Contribution> of_species;
    for (std::size_t b = 0; b < bodies.size(); ++b)
      of_species.push_back(bodies[b].species == species ? BoxExchange::Contribution{&values[b], &filled[b]}
                                                        : BoxExchange::Contribution{});
    const View phi = phase->fraction[0];
    for (const Segment &row : domain_->rows()) {
      const Segment held = phase->rows.within(row);
      std::fill_n(phi.row(row.j, row.k) + held.i_begin, held.size(), 0.0);
    }
    PetscCall(fractions_.add(of_species, {{&phase->fraction, 1}}));
  }
  PetscFunctionReturn(0);
}

std::vector<BodyInBox> FreeBodies::list() const {
  std::vector<BodyInBox> all;
  for (const Body &body : bodies_) all.push_back({body.number, body.species, &body.box, &body.phase, &body.markers});
  return all;
}

namespace {

// The data of a box that put_on_grid() sends at a time: the species, one quantity, and phi at the points of that
// quantity.
enum { species_shown, value_shown, held_shown, all_shown };
constexpr int fraction = -1;  // as a quantity; the others are components of B

// Of a block of cells of a body: phi, or a component of B less its value at rest. Sets all values of the field.
void fill_shown(const BodyInBox &body, const Box &block, int quantity, Field *field) {
  field->clear();
  field->fill(species_shown, body.species);
  const Int3 first = block_offset(*body.box, block);
  const auto of_block = [&first](ConstView view) {
    view.origin += first[0] + first[1] * view.sy + first[2] * view.sz;
    return view;
  };
  const ConstView phi = of_block(body.phase->fraction[0]);
  const View value = (*field)[value_shown], held = (*field)[held_shown];
  if (quantity == fraction) {
    for_points(block.rows(), [&](int i, int j, int k) { value(i, j, k) = held(i, j, k) = phi(i, j, k); });
    return;
  }
  const TensorComponent &component = body.phase->tensor.components()[quantity];
  const auto low = component.steps(phi);
  const ConstView B = of_block(body.phase->tensor.field[quantity]);
  for_points(block.points(component.at), [&](int i, int j, int k) {
    const double *here = &phi(i, j, k);
    held(i, j, k) = 0.25 * ((here[0] + here[-low[0] - low[1]]) + (here[-low[0]] + here[-low[1]]));
    value(i, j, k) = B(i, j, k) - component.rest();
  });
}

}  // namespace

PetscErrorCode FreeBodies::put_on_grid(const std::vector<BodyInBox> &bodies,
                                       const std::map<int, Phase *> &phases) const {
  PetscFunctionBeginUser;
  const std::vector<TensorComponent> &components = tensor_components(domain_->dimension());
  std::vector<Box> blocks;
  std::vector<BoxExchange::NumberedBox> boxes;
  // Cells of bodies, and those around that B is extended to.
  for (const BodyInBox &body : bodies)
    blocks.push_back(body.phase->block(*body.box, ExteriorLayers::layers, ExteriorLayers::layers + 1));
  std::ptrdiff_t largest = 0;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    largest = std::max<std::ptrdiff_t>(largest, blocks[b].layout().size);
    boxes.push_back({&blocks[b], bodies[b].number});
  }
  BoxExchange exchange(*domain_, all_shown);
  PetscCall(exchange.connect(boxes));
  std::vector<double> memory(all_shown * largest);
  Field block;
  std::map<int, Field> most;  // phi of the body that the quantity at a point is of
  for (const auto &[s, phase] : phases) most[s] = Field(*domain_, 1);
  const std::ptrdiff_t size = domain_->layout().size;
  // One quantity at a time, as all of them would take several times the memory of the grid's fields.
  for (int quantity = fraction; quantity < static_cast<int>(components.size()); ++quantity) {
    if (quantity != fraction)
      for (auto &[s, field] : most) field.clear();
    const auto field_of = [&](std::size_t b) -> const Field & {
      block = Field::in_memory(blocks[b], all_shown, memory.data());
      fill_shown(bodies[b], blocks[b], quantity, &block);
      return block;
    };
    PetscCall(exchange.collect(field_of, [&](int number, std::ptrdiff_t at, int count, const double *const *values) {
      const int s = static_cast<int>(values[species_shown][0]);
      const double *value = values[value_shown], *held = values[held_shown];
      Phase &phase = *phases.at(s);
      double *most_held = most.at(s).data() + at;
      if (quantity == fraction) {
        double *phi = phase.fraction.data() + at;
        for (int m = 0; m < count; ++m) {
          if (value[m] > 0) phi[m] += value[m];
          if (held[m] <= most_held[m]) continue;
          most_held[m] = held[m];
          if (phase.label) phase.label.data()[at + m] = number;
        }
        return;
      }
      const double rest = components[quantity].rest();
      double *B = phase.tensor.field.data() + quantity * size + at;
      for (int m = 0; m < count; ++m) {
        const bool first = most_held[m] == 0 && value[m] != 0 && B[m] == rest;
        if (!first && held[m] <= most_held[m]) continue;
        B[m] = rest + value[m];
        most_held[m] = held[m];
      }
    }));
  }
  PetscFunctionReturn(0);
}

std::size_t FreeBodies::bytes() const {
  std::size_t sum = exchange_.bytes();
  for (const Tools &own : tools_) sum += own.memory.size() * sizeof(double);
  for (const Body &body : bodies_) sum += body.phase.bytes() + body.force.bytes();
  for (const SynchronisedCopy &own : copies_) sum += own.moved.bytes() + own.velocity.bytes();
  return sum;
}

}  // namespace eulastic
