#include "physics/free_solids.hpp"

#include "base/deliver.hpp"
#include "field/sides.hpp"
#include "physics/elastic_force.hpp"
#include "physics/transport.hpp"
#include "physics/unresolved.hpp"

#include <algorithm>
#include <cstdint>
#include <utility>

namespace eulastic {
namespace {

// Cells around what is not zero of phi that hold anything: layers, edges, what moves in a step.
constexpr int reach = ExteriorLayers::layers + 2;

// Copies what two boxes share in memory, points on high sides of the domain and `layers` of the first one's ghosts
// included.
void copy_shared(const Box &box, const Field &from, int layers, Field *to) {
  const Layout &a = from.layout(), &b = to->layout();
  Int3 begin, end, shift;
  for (int d = 0; d < 3; ++d) {
    const int ghosts = std::min(layers, a.ghosts[d]), last = std::max(a.cells[d] + ghosts, box.points_end(d, true));
    shift[d] = a.begin[d] - b.begin[d];
    begin[d] = std::max(-ghosts, -shift[d] - b.ghosts[d]);
    end[d] = std::max(begin[d], std::min(last, b.cells[d] + b.ghosts[d] - shift[d]));
  }
  for (int f = 0; f < from.count(); ++f)
    for (int k = begin[2]; k < end[2]; ++k)
      for (int j = begin[1]; j < end[1]; ++j)
        std::copy_n(from[f].row(j, k) + begin[0], end[0] - begin[0],
                    (*to)[f].row(j + shift[1], k + shift[2]) + begin[0] + shift[0]);
}

// No body yet, with the material and the rule of a phase.
Phase empty_like(const Phase &phase, const Box &box) {
  Phase fresh;
  fresh.species = phase.species;
  fresh.material = phase.material;
  fresh.fraction = Field(box, 1);
  const int dimension = box.dimension();
  fresh.tensor.field = Field(box, static_cast<int>(tensor_components(dimension).size()));
  for (int f = 0; f < dimension; ++f) fresh.tensor.field.fill(f, 1);
  fresh.tensor.rule = phase.tensor.rule;
  return fresh;
}

}  // namespace

FreeSolids::FreeSolids(const Domain &domain, const Fluid &fluid, const BoxSides &sides)
    : domain_(&domain), fluid_(fluid), sides_(&sides), exchange_(domain, domain.dimension()) {}

PetscErrorCode FreeSolids::add(int number, int species, const Box &box, Phase &&phase) {
  PetscFunctionBeginUser;
  Body body{number, species, box, std::move(phase), {}};
  body.phase.rows.find_in_box(box, std::as_const(body.phase).fraction[0], reach);
  PetscCall(fit(&body, 0));
  PetscCall(extend(&body));
  const auto after = std::upper_bound(bodies_.begin(), bodies_.end(), number,
                                      [](int least, const Body &other) { return least < other.number; });
  bodies_.insert(after, std::move(body));
  fitted_ = false;
  PetscFunctionReturn(0);
}

// visit(value) for phi and the components of B of a body in the order of packed().
template <class PhaseOrConst, class Visit>
void FreeSolids::for_values(const Box &box, PhaseOrConst &phase, const Visit &visit) {
  const auto visit_field = [&](auto view, const Staggering &at) {
    for (int k = 0; k < box.points_end(2, at[2]); ++k)
      for (int j = 0; j < box.points_end(1, at[1]); ++j)
        for (int i = 0; i < box.points_end(0, at[0]); ++i) visit(view(i, j, k));
  };
  visit_field(phase.fraction[0], at_centre);
  for (int c = 0; c < phase.tensor.field.count(); ++c)
    visit_field(phase.tensor.field[c], phase.tensor.components()[c].at);
}

std::vector<double> FreeSolids::packed(std::size_t b) const {
  const Body &body = bodies_[b];
  const Layout &layout = body.box.layout();
  std::vector<double> values{double(body.number), double(body.species)};
  for (const Int3 &cells : {layout.begin, layout.cells}) values.insert(values.end(), cells.begin(), cells.end());
  for_values(body.box, body.phase, [&](const double &value) { values.push_back(value); });
  return values;
}

namespace {

Box packed_box(const DomainShape &domain, const double *head, int ghosts) {
  Int3 begin{}, cells{};
  for (int d = 0; d < 3; ++d) {
    begin[d] = static_cast<int>(head[2 + d]);
    cells[d] = static_cast<int>(head[5 + d]);
  }
  return Box(domain, begin, cells, ghosts);
}

}  // namespace

std::size_t FreeSolids::packed_values(const DomainShape &domain, const double *head) {
  const Box box = packed_box(domain, head, 0);
  std::size_t sum = static_cast<std::size_t>(box.cell_count());
  for (const TensorComponent &c : tensor_components(box.dimension())) {
    std::size_t points = 1;
    for (int d = 0; d < 3; ++d) points *= box.points_end(d, c.at[d]);
    sum += points;
  }
  return sum;
}

PetscErrorCode FreeSolids::add_packed(const std::vector<double> &packed, const Phase &like) {
  PetscFunctionBeginUser;
  const Box box = packed_box(domain_->domain_shape(), packed.data(), domain_->spec().ghosts);
  Phase phase = empty_like(like, box);
  const double *next = packed.data() + head;
  for_values(box, phase, [&](double &value) { value = *next++; });
  PetscCall(add(static_cast<int>(packed[0]), static_cast<int>(packed[1]), box, std::move(phase)));
  PetscFunctionReturn(0);
}

PetscErrorCode FreeSolids::give(const std::vector<int> &ranks, const std::vector<Phase> &species) {
  struct Part {  // of a packed body
    int number, begin, count;
    double values[510];
  };
  std::vector<Part> parts;
  std::vector<int> to;
  std::vector<Body> kept;
  PetscFunctionBeginUser;
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    if (ranks[b] == domain_->rank()) {
      kept.push_back(std::move(bodies_[b]));
      continue;
    }
    const std::vector<double> values = packed(b);
    for (std::size_t begin = 0; begin < values.size(); begin += std::size(parts[0].values)) {
      Part &part = parts.emplace_back();
      part.number = bodies_[b].number;
      part.begin = static_cast<int>(begin);
      part.count = static_cast<int>(std::min(values.size() - begin, std::size(part.values)));
      std::copy_n(values.data() + begin, part.count, part.values);
      to.push_back(ranks[b]);
    }
  }
  bodies_ = std::move(kept);
  seen_.clear();
  fitted_ = fitted_ && parts.empty();
  PetscCall(deliver(domain_->comm(), to, &parts));
  std::sort(parts.begin(), parts.end(), [](const Part &one, const Part &other) {
    return std::pair(one.number, one.begin) < std::pair(other.number, other.begin);
  });
  std::vector<double> values;
  for (const Part &part : parts) {
    values.insert(values.end(), part.values, part.values + part.count);
    if (values.size() < head || values.size() < head + packed_values(domain_->domain_shape(), values.data())) continue;
    PetscCall(add_packed(values, species[static_cast<int>(values[1])]));
    values.clear();
  }
  PetscFunctionReturn(0);
}

void FreeSolids::clear() {
  bodies_.clear();
  seen_.clear();
  fitted_ = false;
}

// B outside the body, and the force, of a body whose phi and B inside are set.
PetscErrorCode FreeSolids::extend(Body *body) {
  const PhasePlace place{&body->box, sides_, nullptr};
  Phase &phase = body->phase;
  PetscFunctionBeginUser;
  PetscCall(solids_.find_layers(body->box, phase));
  PetscCall(solids_.extend(place, phase, phase.tensor.field, &phase.rows));
  PetscCall(place.update_ghosts(phase.tensor.field, Box::stencil_width, &phase.rows));
  find_force(body, scratch(body->box, body->box.dimension()));
  PetscFunctionReturn(0);
}

bool FreeSolids::is_near_an_end(const Body &body) const {
  const Extent extent = body.phase.extent(body.box);
  bool near = false;
  for (int d = 0; d < body.box.dimension(); ++d) {
    near = near || (!body.box.touches_low(d) && extent.begin[d] < needed);
    near = near || (!body.box.touches_high(d) && extent.end[d] > body.box.cells()[d] - needed);
  }
  return near;
}

// A box that has room around the body, but ends at sides of the domain, with what the old one holds, `layers` of its
// ghosts included.
PetscErrorCode FreeSolids::fit(Body *body, int layers) const {
  PetscFunctionBeginUser;
  const Extent extent = body->phase.extent(body->box);
  Int3 begin{}, cells{1, 1, 1};
  for (int d = 0; d < domain_->dimension(); ++d) {
    int low = body->box.layout().begin[d] + extent.begin[d] - margin;
    int high = body->box.layout().begin[d] + extent.end[d] + margin;
    if (domain_->is_wall(d)) {
      low = std::max(low, 0);
      high = std::min(high, domain_->domain_cells()[d]);
    }
    begin[d] = low;
    cells[d] = high - low;
  }
  const Box box(domain_->domain_shape(), begin, cells, domain_->spec().ghosts);
  Body fitted{body->number, body->species, box, {}, {}};
  fitted.phase = empty_like(body->phase, fitted.box);
  copy_shared(body->box, body->phase.fraction, layers, &fitted.phase.fraction);
  copy_shared(body->box, body->phase.tensor.field, layers, &fitted.phase.tensor.field);
  fitted.phase.rows.find_in_box(fitted.box, std::as_const(fitted.phase).fraction[0], reach);
  fill_wall_ghosts_even(fitted.box, at_centre, fitted.phase.fraction[0], domain_->spec().ghosts, &fitted.phase.rows);
  PetscCall(find_solid(fitted.box, fitted.phase));
  *body = std::move(fitted);
  PetscFunctionReturn(0);
}

// All boxes at once, so that ranks seldom have to tell each other.
PetscErrorCode FreeSolids::fit_boxes(bool *changed) {
  PetscFunctionBeginUser;
  seen_.clear();
  int stale = !fitted_;
  for (const Body &body : bodies_) stale = stale || is_near_an_end(body);
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &stale, 1, MPI_INT, MPI_MAX, domain_->comm()));
  *changed = stale;
  if (!stale) PetscFunctionReturn(0);
  std::vector<BoxExchange::NumberedBox> boxes;
  for (Body &body : bodies_) {
    PetscCall(fit(&body, domain_->spec().ghosts));
    boxes.push_back({&body.box, body.number});
  }
  PetscCall(exchange_.connect(boxes));
  fitted_ = true;
  PetscFunctionReturn(0);
}

PetscErrorCode FreeSolids::follow() {
  PetscFunctionBeginUser;
  bool changed = false;
  PetscCall(fit_boxes(&changed));
  if (changed) find_forces();
  PetscFunctionReturn(0);
}

void FreeSolids::bring_velocity(std::size_t body, const Step &step, const Field &velocity, Field *flow) const {
  exchange_.copy_to_box(body, velocity, *flow);
  fill_wall_ghosts_velocity(bodies_[body].box, *sides_, step.time, *flow, Box::stencil_width);
}

// `memory`: for a velocity on the box, of any values.
void FreeSolids::find_force(Body *body, double *memory) const {
  Field force = Field::in_memory(body->box, body->box.dimension(), memory);
  compute_elastic_force(body->box, 1 / fluid_.density, body->phase, force);
  body->force.take(force, body->phase.tensor.stressed);
}

void FreeSolids::find_forces() {
  for (Body &body : bodies_) find_force(&body, scratch(body.box, body.box.dimension()));
}

double *FreeSolids::scratch(const Box &box, int components) {
  constexpr std::size_t line = 64;  // bytes
  const std::size_t values = components * static_cast<std::size_t>(box.layout().size) + line / sizeof(double);
  if (scratch_.size() < values) scratch_.resize(values);
  return reinterpret_cast<double *>((reinterpret_cast<std::uintptr_t>(scratch_.data()) + line - 1) / line * line);
}

// phi and B of one body over dt, with the velocity in its box; `stage`: as many components as B has, of any values.
PetscErrorCode FreeSolids::move(const Box &box, const Step &step, const Field &flow, Field &stage, Phase *phase) {
  PetscFunctionBeginUser;
  PetscCall(
      interface_.advance(box, step.dt, flow, static_cast<long>(step.number), phase->rows, phase->fraction, stage));
  phase->rows.follow_in_box(box, std::as_const(*phase).fraction[0], reach);
  fill_wall_ghosts_even(box, at_centre, phase->fraction[0], domain_->spec().ghosts, &phase->rows);
  const ActiveSegments before = std::move(phase->tensor.strained);
  PetscCall(find_solid(box, *phase));
  const PhasePlace place{&box, sides_, nullptr};
  PetscCall(solids_.find_layers(box, *phase));
  PetscCall(solids_.advance(place, {step.dt, step.number, fluid_, flow, before}, &phase->rows, *phase, stage));
  PetscCall(place.update_ghosts(phase->tensor.field, Box::stencil_width, &phase->rows));
  PetscFunctionReturn(0);
}

PetscErrorCode FreeSolids::advance(const Step &step, const Field &velocity) {
  PetscFunctionBeginUser;
  PetscCall(exchange_.fetch(velocity));
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    Body &body = bodies_[b];
    const int dimension = body.box.dimension(), components = body.phase.tensor.field.count();
    double *memory = scratch(body.box, components + dimension);
    Field stage = Field::in_memory(body.box, components, memory);
    Field flow = Field::in_memory(body.box, dimension, memory + components * body.box.layout().size);
    bring_velocity(b, step, velocity, &flow);
    PetscCall(move(body.box, step, flow, stage, &body.phase));
  }
  bool changed = false;
  PetscCall(fit_boxes(&changed));
  find_forces();
  PetscFunctionReturn(0);
}

PetscErrorCode FreeSolids::look(const Step &step, const Field &velocity, std::vector<BodyInBox> *seen) {
  PetscFunctionBeginUser;
  PetscCall(exchange_.fetch(velocity));
  *seen = list();
  seen_.clear();
  seen_.resize(bodies_.size());
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    const Body &body = bodies_[b];
    Seen &own = seen_[b];
    own.velocity = Field(body.box, body.box.dimension());
    bring_velocity(b, step, velocity, &own.velocity);
    (*seen)[b].velocity = &own.velocity;
    if (step.dt == 0) continue;
    own.moved.copy_from(body.phase);
    const int components = body.phase.tensor.field.count();
    Field stage = Field::in_memory(body.box, components, scratch(body.box, components));
    PetscCall(move(body.box, step, own.velocity, stage, &own.moved));
    (*seen)[b].phase = &own.moved;
  }
  PetscFunctionReturn(0);
}

std::vector<BodyInBox> FreeSolids::list() const {
  std::vector<BodyInBox> all;
  for (const Body &body : bodies_) all.push_back({body.number, body.species, &body.box, &body.phase});
  return all;
}

PetscErrorCode FreeSolids::forget_unresolved(const std::vector<double> &trace, long *count) {
  PetscFunctionBeginUser;
  *count = 0;
  bool any = false;
  for (const double most : trace) any = any || may_be_unresolved(most, domain_->dimension());
  if (!any) PetscFunctionReturn(0);
  for (Body &body : bodies_) {
    if (!may_be_unresolved(trace[body.species], domain_->dimension())) continue;
    const long found = eulastic::forget_unresolved(body.box, body.phase);
    if (found > 0) PetscCall(extend(&body));
    *count += found;
  }
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, count, 1, MPI_LONG, MPI_SUM, domain_->comm()));
  PetscFunctionReturn(0);
}

PetscErrorCode FreeSolids::show(const std::vector<BodyInBox> &seen, const std::map<int, Phase *> &phases) const {
  PetscFunctionBeginUser;
  const int dimension = domain_->dimension();
  const std::vector<TensorComponent> &components = tensor_components(dimension);
  const int tensors = static_cast<int>(components.size());
  // Of a box: the species, phi, B, and for every component of B phi where it lives.
  enum { species, fraction, tensor };
  const int part = tensor + tensors, all = part + tensors;
  std::vector<Field> fields;
  std::vector<const Field *> shown;
  std::vector<BoxExchange::NumberedBox> boxes;
  for (const BodyInBox &body : seen) {
    const Box &box = *body.box;
    Field &field = fields.emplace_back(box, all);
    field.fill(species, body.species);
    const ConstView phi = body.phase->fraction[0];
    for_points(box.rows(), [&](int i, int j, int k) { field[fraction](i, j, k) = phi(i, j, k); });
    for (int c = 0; c < tensors; ++c) {
      const auto &[a, b, at] = components[c];
      const std::ptrdiff_t low_a = a == b ? 0 : phi.stride(a), low_b = a == b ? 0 : phi.stride(b);
      for (int k = 0; k < box.points_end(2, at[2]); ++k)
        for (int j = 0; j < box.points_end(1, at[1]); ++j)
          for (int i = 0; i < box.points_end(0, at[0]); ++i) {
            const double *here = &phi(i, j, k);
            field[part + c](i, j, k) = 0.25 * ((here[0] + here[-low_a - low_b]) + (here[-low_a] + here[-low_b]));
            field[tensor + c](i, j, k) = body.phase->tensor.field[c](i, j, k) - components[c].rest();
          }
    }
    boxes.push_back({&box, body.number});
  }
  for (const Field &field : fields) shown.push_back(&field);
  std::map<int, Field> most;  // phi of the body that B at the point is of
  for (const auto &[s, phase] : phases) most[s] = Field::at_rest(*domain_, 1 + tensors);
  BoxExchange exchange(*domain_, all);
  PetscCall(exchange.connect(boxes));
  const std::ptrdiff_t size = domain_->layout().size;
  PetscCall(exchange.collect(shown, [&](int number, std::ptrdiff_t at, const double *values) {
    const int s = static_cast<int>(values[species]);
    Phase &phase = *phases.at(s);
    double *best = most.at(s).data() + at;
    if (values[fraction] > 0) phase.fraction.data()[at] += values[fraction];
    if (values[fraction] > *best) {
      *best = values[fraction];
      if (phase.label) phase.label.data()[at] = number;
    }
    for (int c = 0; c < tensors; ++c) {
      double &B = phase.tensor.field.data()[c * size + at], &largest = best[(1 + c) * size];
      const bool first = largest == 0 && values[tensor + c] != 0 && B == components[c].rest();
      if (!first && values[part + c] <= largest) continue;
      B = components[c].rest() + values[tensor + c];
      largest = values[part + c];
    }
  }));
  PetscFunctionReturn(0);
}

std::size_t FreeSolids::bytes() const {
  std::size_t sum = scratch_.size() * sizeof(double) + exchange_.bytes();
  const auto add = [&sum](const Phase &phase) { sum += phase.fraction.bytes() + phase.tensor.field.bytes(); };
  for (const Body &body : bodies_) {
    add(body.phase);
    sum += body.force.bytes();
  }
  for (const Seen &own : seen_) {
    if (own.moved.fraction) add(own.moved);
    sum += own.velocity.bytes();
  }
  return sum;
}

PetscErrorCode FreeSolids::add_forces(const std::vector<BoxExchange::Target> &targets) {
  PetscFunctionBeginUser;
  std::vector<BoxExchange::Contribution> forces;
  for (const Body &body : bodies_) forces.push_back({&body.force, &body.phase.tensor.stressed});
  PetscCall(exchange_.add(forces, targets));
  PetscFunctionReturn(0);
}

}  // namespace eulastic
