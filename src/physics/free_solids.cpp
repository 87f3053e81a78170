#include "physics/free_solids.hpp"

#include "field/sides.hpp"
#include "physics/elastic_force.hpp"
#include "physics/transport.hpp"

#include <algorithm>
#include <cstdint>
#include <utility>

namespace eulastic {
namespace {

// Cells around what is not zero of phi that hold anything: layers, edges, what moves in a step.
constexpr int reach = ExteriorLayers::layers + 2;

// Copies what two boxes share in memory, `layers` of the first one's ghosts included.
void copy_shared(const Field &from, int layers, Field *to) {
  const Layout &a = from.layout(), &b = to->layout();
  Int3 begin, end, shift;
  for (int d = 0; d < 3; ++d) {
    const int ghosts = std::min(layers, a.ghosts[d]);
    shift[d] = a.begin[d] - b.begin[d];
    begin[d] = std::max(-ghosts, -shift[d] - b.ghosts[d]);
    end[d] = std::max(begin[d], std::min(a.cells[d] + ghosts, b.cells[d] + b.ghosts[d] - shift[d]));
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

// Cells in which phi is not 0, begin to end in every direction.
struct Extent {
  Int3 begin, end;
};

Extent extent_of(const Box &box, const Phase &phase) {
  const Int3 &n = box.cells();
  Extent extent{n, {0, 0, 0}};
  const ConstView phi = phase.fraction[0];
  for (int k = 0; k < n[2]; ++k)
    for (int j = 0; j < n[1]; ++j) {
      const Segment known = phase.rows.within({0, n[0], j, k});
      const double *row = phi.row(j, k), *begin = row + known.i_begin, *end = row + known.i_end;
      while (begin < end && *begin == 0) ++begin;
      if (begin == end) continue;
      while (end[-1] == 0) --end;
      const Int3 first{static_cast<int>(begin - row), j, k}, last{static_cast<int>(end - row), j + 1, k + 1};
      for (int d = 0; d < 3; ++d) {
        extent.begin[d] = std::min(extent.begin[d], first[d]);
        extent.end[d] = std::max(extent.end[d], last[d]);
      }
    }
  return extent;
}

}  // namespace

FreeSolids::FreeSolids(const Domain &domain, const Fluid &fluid, const BoxSides &sides)
    : domain_(&domain), fluid_(fluid), sides_(&sides), exchange_(domain, domain.dimension()) {}

PetscErrorCode FreeSolids::add(int number, const Box &box, Phase &&phase) {
  PetscFunctionBeginUser;
  Body body{number, box, std::move(phase), Field(box, box.dimension()), Field(box, box.dimension())};
  body.phase.rows.find_in_box(box, std::as_const(body.phase).fraction[0], reach);
  PetscCall(fit(&body, 0));
  PetscCall(solids_.find_layers(body.box, body.phase));
  PetscCall(solids_.extend({&body.box, sides_, nullptr}, body.phase, body.phase.tensor.field, &body.phase.rows));
  compute_elastic_force(body.box, 1 / fluid_.density, body.phase, body.force);
  const auto after = std::upper_bound(bodies_.begin(), bodies_.end(), number,
                                      [](int least, const Body &other) { return least < other.number; });
  bodies_.insert(after, std::move(body));
  fitted_ = false;
  PetscFunctionReturn(0);
}

bool FreeSolids::is_near_an_end(const Body &body) const {
  const Extent extent = extent_of(body.box, body.phase);
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
  const Extent extent = extent_of(body->box, body->phase);
  Int3 begin{}, cells{1, 1, 1};
  for (int d = 0; d < domain_->dimension(); ++d) {
    const int N = domain_->domain_cells()[d];
    int low = body->box.layout().begin[d] + extent.begin[d] - (needed + travel);
    int high = body->box.layout().begin[d] + extent.end[d] + (needed + travel);
    if (domain_->is_wall(d)) {
      low = std::max(low, 0);
      high = std::min(high, N);
    }
    PetscCheck(high - low <= N, PETSC_COMM_SELF, PETSC_ERR_ARG_SIZ,
               "body %d is %d cells long with the layers around it, the domain %d", body->number, high - low, N);
    begin[d] = low;
    cells[d] = high - low;
  }
  Body fitted{body->number, Box(domain_->domain_shape(), begin, cells, domain_->spec().ghosts), {}, {}, {}};
  fitted.phase = empty_like(body->phase, fitted.box);
  copy_shared(body->phase.fraction, layers, &fitted.phase.fraction);
  copy_shared(body->phase.tensor.field, layers, &fitted.phase.tensor.field);
  for (const auto &[from, to] : {std::pair(&body->force, &fitted.force), {&body->change, &fitted.change}}) {
    *to = Field(fitted.box, domain_->dimension());
    copy_shared(*from, layers, to);
  }
  fitted.phase.rows.find_in_box(fitted.box, std::as_const(fitted.phase).fraction[0], reach);
  fill_wall_ghosts_even(fitted.box, at_centre, fitted.phase.fraction[0], domain_->spec().ghosts, &fitted.phase.rows);
  PetscCall(find_solid(fitted.box, fitted.phase));
  *body = std::move(fitted);
  PetscFunctionReturn(0);
}

// All boxes at once, so that ranks seldom have to tell each other.
PetscErrorCode FreeSolids::fit_boxes() {
  PetscFunctionBeginUser;
  int stale = !fitted_;
  for (const Body &body : bodies_) stale = stale || is_near_an_end(body);
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &stale, 1, MPI_INT, MPI_MAX, domain_->comm()));
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

PetscErrorCode FreeSolids::advance(const Step &step, const Field &velocity) {
  PetscFunctionBeginUser;
  PetscCall(fit_boxes());
  PetscCall(exchange_.fetch(velocity));
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    Body &body = bodies_[b];
    const Box &box = body.box;
    Phase &phase = body.phase;
    const int dimension = box.dimension(), components = phase.tensor.field.count();
    const std::size_t values = static_cast<std::size_t>(box.layout().size);
    constexpr std::size_t line = 8;  // values
    if (scratch_.size() < (components + dimension) * values + line)
      scratch_.resize((components + dimension) * values + line);
    auto *memory = reinterpret_cast<double *>((reinterpret_cast<std::uintptr_t>(scratch_.data()) + 63) / 64 * 64);
    Field stage = Field::in_memory(box, components, memory);
    Field flow = Field::in_memory(box, dimension, memory + components * values);
    exchange_.copy_to_box(b, velocity, flow);
    fill_wall_ghosts_velocity(box, *sides_, step.time, flow, Box::stencil_width);
    PetscCall(
        interface_.advance(box, step.dt, flow, static_cast<long>(step.number), phase.rows, phase.fraction, stage));
    phase.rows.follow_in_box(box, std::as_const(phase).fraction[0], reach);
    fill_wall_ghosts_even(box, at_centre, phase.fraction[0], domain_->spec().ghosts, &phase.rows);
    const ActiveSegments before = std::move(phase.tensor.strained);
    PetscCall(find_solid(box, phase));
    const PhasePlace place{&box, sides_, nullptr};
    PetscCall(solids_.find_layers(box, phase));
    PetscCall(solids_.advance(place, {step.dt, step.number, fluid_, flow, before}, &phase.rows, phase, stage));
    PetscCall(place.update_ghosts(phase.tensor.field, Box::stencil_width, &phase.rows));
    body.force.swap(body.change);
    compute_elastic_force(box, 1 / fluid_.density, phase, body.force);
  }
  PetscFunctionReturn(0);
}

PetscErrorCode FreeSolids::add_forces(Field &rate, const Slope &slope) {
  PetscFunctionBeginUser;
  std::vector<BoxExchange::Contribution> forces, changes;
  for (Body &body : bodies_) forces.push_back({&body.force, &body.phase.tensor.stressed});
  PetscCall(exchange_.add(forces, rate));
  if (!slope.field) PetscFunctionReturn(0);
  for (Body &body : bodies_) {
    for (int a = 0; a < domain_->dimension(); ++a)
      for (const Segment &s : body.phase.tensor.stressed.all()) {
        const double *now = body.force[a].row(s.j, s.k);
        double *change = body.change[a].row(s.j, s.k);
        for (int i = s.i_begin; i < s.i_end; ++i) change[i] = slope.scale * (now[i] - change[i]);
      }
    changes.push_back({&body.change, &body.phase.tensor.stressed});
  }
  PetscCall(exchange_.add(changes, *slope.field));
  PetscFunctionReturn(0);
}

}  // namespace eulastic
