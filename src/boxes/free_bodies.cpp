#include "boxes/free_bodies.hpp"

#include "base/send_to_ranks.hpp"
#include "boxes/receptors.hpp"
#include "field/boundaries.hpp"
#include "field/inlet_velocity.hpp"
#include "membranes/stretch_force.hpp"
#include "solids/elastic_force.hpp"
#include "solids/transport.hpp"
#include "solids/unresolved.hpp"

#include <algorithm>
#include <numeric>
#include <utility>

namespace eulastic {

// Scratch fields of a step of a body that is no membrane.
int FreeBodies::stage_fields(const Phase &phase) {
  return std::max<int>(phase.tensor.field.count(), InterfaceTransport::work_fields);
}

namespace {

bool has_markers(const Material &material) {
  return material.is_membrane() && material.membrane.scheme == kernels::MembraneScheme::markers;
}

}  // namespace

void FreeBodies::copy_shared(const Box &box, const Field &from, int layers, Field *to) {
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

Phase FreeBodies::empty_like(const Phase &phase, const Box &box) {
  Phase fresh;
  fresh.species = phase.species;
  fresh.material = phase.material;
  fresh.fraction = Field(box, 1);
  const int dimension = box.dimension();
  fresh.tensor.field = phase.material.carries_tensor()
                           ? Field(box, static_cast<int>(tensor_components(dimension).size()))
                           : undeformed_tensor(box);
  for (int f = 0; f < dimension && phase.material.carries_tensor(); ++f) fresh.tensor.field.fill(f, 1);
  fresh.tensor.centred = phase.tensor.centred;
  fresh.tensor.rule = phase.tensor.rule;
  return fresh;
}

FreeBodies::FreeBodies(const Domain &domain, const Fluid &fluid, const BoundaryConditions &sides, bool extends)
    : domain_(&domain),
      fluid_(fluid),
      sides_(&sides),
      exchange_(domain, domain.dimension()),
      fractions_(domain, 1),
      extends_(extends),
      net_force_(domain, false),
      tools_(threads(), Tools{{}, SolidTransport(extends), {}}) {}

void FreeBodies::set_surroundings(bool drifts, const std::vector<const Phase *> &rigid) {
  drifts_ = drifts;
  walls_ = rigid.empty() ? Field() : Field(*domain_, 1);
  for (const Phase *phase : rigid)
    for_points(domain_->rows(), [&](int i, int j, int k) { walls_[0](i, j, k) += phase->fraction[0](i, j, k); });
  fitted_ = false;
}

PetscErrorCode FreeBodies::add(int number, int species, const Box &box, Phase &&phase,
                               std::vector<SurfaceMarker> &&markers, std::vector<Receptor> &&receptors) {
  PetscFunctionBeginUser;
  Body body{number, species, box, std::move(phase), {}, std::move(markers)};
  body.receptors = std::move(receptors);
  body.phase.rows.find_in_box(box, std::as_const(body.phase).fraction[0],
                              rows_reach(body.phase.material, domain_->spec().ghosts));
  PetscCall(fit(&body, 0));
  PetscCall(extend(&body));
  const auto after = std::upper_bound(bodies_.begin(), bodies_.end(), number,
                                      [](int least, const Body &other) { return least < other.number; });
  bodies_.insert(after, std::move(body));
  fitted_ = false;
  PetscFunctionReturn(0);
}

// visit(value) for phi and the components of B of a body in the order of packed(), at the points of a block that begins
// at cell `first` of its box.
template <class PhaseOrConst, class Visit>
void FreeBodies::for_values(const Box &block, const Int3 &first, PhaseOrConst &phase, const Visit &visit) {
  const auto visit_field = [&](auto view, const Staggering &at) {
    for_points(block.points(at), [&](int i, int j, int k) { visit(view(first[0] + i, first[1] + j, first[2] + k)); });
  };
  visit_field(phase.fraction[0], at_centre);
  for (int c = 0; c < phase.tensor.field.count(); ++c)
    visit_field(phase.tensor.field[c], phase.tensor.components()[c].at);
}

// The cells that hold anything of the body, and one more for the edges at their ends: all else follows from these.
std::vector<double> FreeBodies::packed(std::size_t b) const {
  const Body &body = bodies_[b];
  const Box block = body.phase.block(body.box, 0, 1);
  const Layout &layout = block.layout();
  std::vector<double> values{double(body.number), double(body.species)};
  for (const Int3 &place : {layout.begin, layout.cells}) values.insert(values.end(), place.begin(), place.end());
  values.push_back(double(body.markers.size()));
  for_values(block, block_offset(body.box, block), body.phase, [&](const double &value) { values.push_back(value); });
  const auto add = [&values](const auto &points) {
    for (const auto &point : points) {
      const auto numbers = point.packed();
      values.insert(values.end(), numbers.begin(), numbers.end());
    }
  };
  add(body.markers);
  add(body.receptors);
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

std::size_t FreeBodies::packed_values(const DomainShape &domain, bool centred, const double *head) {
  const Box box = packed_box(domain, head, 0);
  std::size_t sum = static_cast<std::size_t>(box.cell_count() + head[8] * SurfaceMarker::numbers);
  for (const TensorComponent &c : tensor_components(box.dimension(), centred)) {
    std::size_t points = 1;
    for (int d = 0; d < 3; ++d) points *= box.points_end(d, c.at[d]);
    sum += points;
  }
  return sum;
}

PetscErrorCode FreeBodies::add_packed(const std::vector<double> &packed, const Phase &like) {
  PetscFunctionBeginUser;
  const Box box = packed_box(domain_->domain_shape(), packed.data(), domain_->spec().ghosts);
  Phase phase = empty_like(like, box);
  const double *next = packed.data() + head;
  for_values(box, {0, 0, 0}, phase, [&](double &value) { value = *next++; });
  std::vector<SurfaceMarker> markers;
  std::vector<Receptor> receptors;
  for (int m = 0; m < static_cast<int>(packed[head - 1]); ++m, next += SurfaceMarker::numbers)
    markers.push_back(SurfaceMarker::unpacked(next));
  for (; next < packed.data() + packed.size(); next += Receptor::numbers) receptors.push_back(Receptor::unpacked(next));
  PetscCall(add(static_cast<int>(packed[0]), static_cast<int>(packed[1]), box, std::move(phase), std::move(markers),
                std::move(receptors)));
  PetscFunctionReturn(0);
}

PetscErrorCode FreeBodies::add_copy(int number, int copy, const Int3 &shift, const Phase &like) {
  PetscFunctionBeginUser;
  const auto original =
      std::find_if(bodies_.begin(), bodies_.end(), [&](const Body &body) { return body.number == number; });
  std::vector<double> values = packed(original - bodies_.begin());
  values[0] = copy;
  for (int d = 0; d < 3; ++d) values[2 + d] += shift[d];
  const std::size_t receptors = values.size() - original->receptors.size() * Receptor::numbers;
  // A marker's place at rest stays: only differences count.
  for (std::size_t m = original->markers.size(); m > 0; --m)
    for (int d = 0; d < 3; ++d) values[receptors - m * SurfaceMarker::numbers + 3 + d] += shift[d];
  values.resize(receptors);
  for (const Receptor &receptor : original->receptors) {
    Receptor moved{receptor.place};
    for (int d = 0; d < 3; ++d) moved.place[d] += shift[d] * domain_->spacing()[d];
    const auto numbers = moved.packed();
    values.insert(values.end(), numbers.begin(), numbers.end());
  }
  PetscCall(add_packed(values, like));
  PetscFunctionReturn(0);
}

PetscErrorCode FreeBodies::give(const std::vector<int> &ranks, const std::vector<Phase> &species) {
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
  copies_.clear();
  fitted_ = fitted_ && parts.empty();
  PetscCall(send_to_ranks(domain_->comm(), to, &parts));
  std::sort(parts.begin(), parts.end(), [](const Part &one, const Part &other) {
    return std::pair(one.number, one.begin) < std::pair(other.number, other.begin);
  });
  std::vector<double> values;
  for (std::size_t p = 0; p < parts.size(); ++p) {
    values.insert(values.end(), parts[p].values, parts[p].values + parts[p].count);
    if (p + 1 < parts.size() && parts[p + 1].number == parts[p].number) continue;
    PetscCall(add_packed(values, species[static_cast<int>(values[1])]));
    values.clear();
  }
  PetscFunctionReturn(0);
}

void FreeBodies::remove(const std::vector<std::size_t> &which) {
  for (auto b = which.rbegin(); b != which.rend(); ++b)
    bodies_.erase(bodies_.begin() + static_cast<std::ptrdiff_t>(*b));
  copies_.clear();
  fitted_ = fitted_ && which.empty();
}

void FreeBodies::clear() {
  bodies_.clear();
  copies_.clear();
  fitted_ = false;
}

// B outside the body, of a body whose phi and B inside are set.
PetscErrorCode FreeBodies::extend(Body *body) {
  const PhaseDomain place{&body->box, sides_, nullptr};
  Phase &phase = body->phase;
  PetscFunctionBeginUser;
  if (phase.material.is_membrane()) {
    MembraneMechanics membrane(place);
    Field work = scratch(body->box, MembraneMechanics::work_fields);
    PetscCall(membrane.find(phase, work));
    PetscCall(membrane.extend(&phase));
    PetscFunctionReturn(0);
  }
  if (!phase.material.elastic()) PetscFunctionReturn(0);
  if (!extends_) PetscCall(reset_exterior(body->box, phase.rows, phase));
  PetscCall(tools().solids.find_layers(body->box, phase));
  PetscCall(tools().solids.extend(place, phase, phase.tensor.field, &phase.rows));
  PetscCall(place.update_ghosts(phase.tensor.field, Box::stencil_width, &phase.rows));
  PetscFunctionReturn(0);
}

bool FreeBodies::is_near_an_end(const Body &body) const {
  const Extent extent = body.phase.extent(body.box);
  const int room = needed(body.phase.material);
  bool near = false;
  for (int d = 0; d < body.box.dimension(); ++d) {
    near = near || (!body.box.touches_low(d) && extent.begin[d] < room);
    near = near || (!body.box.touches_high(d) && extent.end[d] > body.box.cells()[d] - room);
  }
  return near;
}

// A box that has room around the body, but ends at sides of the domain, with what the old one holds, `layers` of its
// ghosts included.
PetscErrorCode FreeBodies::fit(Body *body, int layers) const {
  PetscFunctionBeginUser;
  const Extent extent = body->phase.extent(body->box);
  const int room = margin(body->phase.material);
  Int3 begin{}, cells{1, 1, 1};
  for (int d = 0; d < domain_->dimension(); ++d) {
    int low = body->box.layout().begin[d] + extent.begin[d] - room;
    int high = body->box.layout().begin[d] + extent.end[d] + room;
    if (domain_->is_wall(d)) {
      low = std::max(low, 0);
      high = std::min(high, domain_->domain_cells()[d]);
    }
    begin[d] = low;
    cells[d] = high - low;
  }
  const Box box(domain_->domain_shape(), begin, cells, domain_->spec().ghosts);
  Body fitted{body->number, body->species, box, {}, {}, std::move(body->markers)};
  fitted.receptors = std::move(body->receptors);
  fitted.phase = empty_like(body->phase, fitted.box);
  copy_shared(body->box, body->phase.fraction, layers, &fitted.phase.fraction);
  copy_shared(body->box, body->phase.tensor.field, layers, &fitted.phase.tensor.field);
  fitted.phase.rows.find_in_box(fitted.box, std::as_const(fitted.phase).fraction[0],
                                rows_reach(fitted.phase.material, domain_->spec().ghosts));
  fill_wall_ghosts_even(fitted.box, at_centre, fitted.phase.fraction[0], domain_->spec().ghosts, &fitted.phase.rows);
  PetscCall(find_solid(fitted.box, fitted.phase));
  *body = std::move(fitted);
  PetscFunctionReturn(0);
}

// All boxes at once, so that ranks seldom have to tell each other.
PetscErrorCode FreeBodies::fit_boxes(bool *changed, long *unresolved) {
  PetscFunctionBeginUser;
  copies_.clear();
  long sums[2] = {!fitted_, *unresolved};
  for (const Body &body : bodies_) sums[0] += is_near_an_end(body);
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, sums, 2, MPI_LONG, MPI_SUM, domain_->comm()));
  *changed = sums[0] > 0;
  *unresolved = sums[1];
  if (!*changed) PetscFunctionReturn(0);
  ++fits_;
  std::vector<BoxExchange::NumberedBox> boxes;
  for (Body &body : bodies_) {
    PetscCall(fit(&body, domain_->spec().ghosts));
    boxes.push_back({&body.box, body.number});
  }
  PetscCall(exchange_.connect(boxes));
  fractions_are_connected_ = false;
  PetscCall(find_walls());
  fitted_ = true;
  PetscFunctionReturn(0);
}

PetscErrorCode FreeBodies::follow() {
  PetscFunctionBeginUser;
  bool changed = false;
  long unresolved = 0;
  PetscCall(fit_boxes(&changed, &unresolved));
  if (changed) PetscCall(find_forces());
  PetscFunctionReturn(0);
}

void FreeBodies::bring_velocity(std::size_t body, const Step &step, const Field &velocity, Field *flow) const {
  const Box &box = bodies_[body].box;
  const bool membrane = bodies_[body].phase.material.is_membrane();
  exchange_.copy_to_box(body, velocity, *flow);
  const BoundaryConditions *sides = sides_;
  BoundaryConditions own;  // where a side is fed: what is known of its velocity here are the faces of the box
  for (const auto [d, high] : box.sides()) {
    const int away = high ? domain_->domain_cells()[d] - box.layout().begin[d] - box.cells()[d] : box.layout().begin[d];
    if (!(*sides_)[d][high].fed || away > box.layout().ghosts[d]) continue;
    if (sides == sides_) own = *sides_;
    sides = &own;
    // Of a side among the ghosts, which nothing of the body reads, any values will do.
    const int local = high && away == 0 ? box.cells()[d] : 0;
    own[d][high].fed = std::make_shared<InletVelocity>(InletVelocity::of_faces(box, std::as_const(*flow)[d], d, local));
  }
  fill_wall_ghosts_velocity(box, *sides, step.time, *flow,
                            membrane ? MembraneMechanics::velocity_ghosts : Box::stencil_width);
}

// Walls in the boxes of membranes.
PetscErrorCode FreeBodies::find_walls() {
  PetscFunctionBeginUser;
  if (walls_) {
    PetscCall(connect_fractions());
    PetscCall(fractions_.fetch(walls_));
  }
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    Body &body = bodies_[b];
    if (!body.phase.material.is_membrane()) continue;
    Field work = scratch(body.box, WallFilm::work_fields + 1), scratch_of_film = work.part(1, WallFilm::work_fields);
    work.fill(0, 0);
    if (walls_) fractions_.copy_to_box(b, walls_, work);
    body.film.find(body.box, *sides_, {std::as_const(work)[0]}, scratch_of_film);
  }
  PetscFunctionReturn(0);
}

PetscErrorCode FreeBodies::connect_fractions() {
  PetscFunctionBeginUser;
  if (fractions_are_connected_) PetscFunctionReturn(0);
  std::vector<BoxExchange::NumberedBox> boxes;
  for (const Body &body : bodies_) boxes.push_back({&body.box, body.number});
  PetscCall(fractions_.connect(boxes));
  fractions_are_connected_ = true;
  PetscFunctionReturn(0);
}

PetscErrorCode FreeBodies::find_force(Body *body) {
  PetscFunctionBeginUser;
  const int dimension = body->box.dimension();
  if (body->phase.material.is_membrane()) {
    Field all = scratch(body->box, MembraneMechanics::work_fields + dimension), force = all.part(0, dimension),
          work = all.part(dimension, MembraneMechanics::work_fields);
    MembraneMechanics membrane({&body->box, sides_, nullptr});
    PetscCall(membrane.find(body->phase, work));
    PetscCall(gather_force(membrane, body, force));
    PetscFunctionReturn(0);
  }
  Field all = scratch(body->box, dimension + CapillaryForce::work_fields), force = all.part(0, dimension),
        work = all.part(dimension, CapillaryForce::work_fields);
  const bool tension = body->phase.material.surface_tension > 0;
  if (tension) {
    constexpr double least = 1e-300;
    const int reach = std::max(CapillaryForce::reach, body->phase.tensor.rule.reach);
    body->tension_faces.build(body->box, std::as_const(body->phase).fraction[0], body->phase.rows, least, reach, reach);
    for (const Segment &s : body->tension_faces.all())
      for (int a = 0; a < dimension; ++a) std::fill_n(force[a].row(s.j, s.k) + s.i_begin, s.size(), 0.0);
  }
  if (body->phase.material.elastic()) compute_elastic_force(body->box, 1 / fluid_.density, body->phase, force);
  if (tension) {
    CapillaryForce capillary(body->box, nullptr);
    PetscCall(capillary.find(body->phase, work));
    capillary.add_force(1 / fluid_.density, force, {}, &net_force_);
  }
  body->force.take(force, body->forced());
  PetscFunctionReturn(0);
}

// Sets `force`, of any values, to the force per mass of a membrane whose surface has been found, where stress is felt;
// `of_step`: with that of a stretch force, and the net force is added up. `samples`: of the surface, or null.
PetscErrorCode FreeBodies::membrane_force(MembraneMechanics &membrane, const Body &body, const Phase &phase,
                                          bool of_step, Field &force, std::vector<SurfaceSample> *samples) {
  const Box &box = body.box;
  const int n = box.cells()[0];
  const double scale = 1 / fluid_.density;
  PetscFunctionBeginUser;
  for (const Segment &s : phase.tensor.stressed.all())
    for (int a = 0; a < box.dimension(); ++a) std::fill_n(force[a].row(s.j, s.k) + s.i_begin, s.size(), 0.0);
  std::vector<double> bending_energy;
  PetscCall(membrane.for_force_rows(
      phase,
      [&](int part, int a, int j, int k, double *added) {
        add_force_row(n, added, 0, force[a].row(j, k), nullptr);
        if (!of_step || !drifts_) return;
        for (int i = 0; i < n; ++i) added[i] *= scale;
        net_force_.add_row(box, part, a, added);
      },
      samples ? &bending_energy : nullptr));
  if (samples) *samples = membrane.sample(phase, bending_energy);
  body.film.add_force(phase, force);
  if (of_step && is_stretched(phase.material)) StretchedBody(box, phase).add_force(force[0]);
  for (const Segment &s : phase.tensor.stressed.all())
    for (int a = 0; a < box.dimension(); ++a)
      for (int i = s.i_begin; i < s.i_end; ++i) force[a](i, s.j, s.k) *= scale;
  PetscFunctionReturn(0);
}

PetscErrorCode FreeBodies::gather_force(MembraneMechanics &membrane, Body *body, Field &force) {
  PetscFunctionBeginUser;
  body->surface.clear();
  PetscCall(membrane_force(membrane, *body, body->phase, true, force, keeps_surfaces_ ? &body->surface : nullptr));
  body->force.take(force, body->phase.tensor.stressed);
  PetscFunctionReturn(0);
}

PetscErrorCode FreeBodies::find_forces() {
  PetscFunctionBeginUser;
  net_force_ = NetForce(*domain_, drifts_);
  PetscCall(for_bodies([this](std::size_t b) { return find_force(&bodies_[b]); }));
  PetscCall(net_force_.compute_mean(&mean_force_));
  PetscFunctionReturn(0);
}

// Memory for that many components on a box, of any values, until the next call of this thread.
Field FreeBodies::scratch(const Box &box, int components) {
  constexpr std::size_t line = 64;  // bytes
  const std::size_t values = components * static_cast<std::size_t>(box.layout().size) + line / sizeof(double);
  std::vector<double> &memory = tools().memory;
  if (memory.size() < values) memory.resize(values);
  const auto aligned = (reinterpret_cast<std::uintptr_t>(memory.data()) + line - 1) / line * line;
  return Field::in_memory(box, components, reinterpret_cast<double *>(aligned));
}

// phi and B, but for B_s, of one body over dt, with the velocity in its box; `stage`: as many components as B has, of
// any values.
PetscErrorCode FreeBodies::move(const Box &box, const Step &step, const Field &flow, Field &stage, Phase *phase) {
  PetscFunctionBeginUser;
  PetscCall(tools().interface.advance(box, step.dt, flow, static_cast<long>(step.number), phase->rows, phase->fraction,
                                      stage));
  phase->rows.update_in_box(box, std::as_const(*phase).fraction[0],
                            rows_reach(phase->material, domain_->spec().ghosts));
  fill_wall_ghosts_even(box, at_centre, phase->fraction[0], domain_->spec().ghosts, &phase->rows);
  const ActiveSegments before = std::move(phase->tensor.strained);
  PetscCall(find_solid(box, *phase));
  if (!phase->material.elastic()) PetscFunctionReturn(0);
  const PhaseDomain place{&box, sides_, nullptr};
  PetscCall(tools().solids.find_layers(box, *phase));
  PetscCall(tools().solids.advance(place, {step.dt, step.number, fluid_, flow, before}, &phase->rows, *phase, stage));
  PetscCall(place.update_ghosts(phase->tensor.field, Box::stencil_width, &phase->rows));
  PetscFunctionReturn(0);
}

// The same of a membrane, with its markers, and its force.
PetscErrorCode FreeBodies::move_membrane(const Step &step, const Field &flow, Body *body, Field &work,
                                         long *unresolved) {
  Phase &phase = body->phase;
  PetscFunctionBeginUser;
  SurfaceMarkers markers(body->box);
  MembraneMechanics membrane({&body->box, sides_, nullptr});
  Field force = work.part(MembraneMechanics::work_fields, body->box.dimension());
  std::vector<SurfaceMarkers::Strain> strains;
  const bool marked = !body->markers.empty();
  if (marked) PetscCall(markers.move(step.dt, flow, &body->markers));
  PetscCall(membrane.find(phase, work));
  if (marked) markers.find_strain(membrane.surface(), body->species, &strains);
  PetscCall(membrane.move(step.dt, flow, strains, &phase, unresolved));
  if (marked) markers.pull_to_surface(membrane.surface(), membrane.surface_fields(), body->species, &body->markers);
  PetscCall(gather_force(membrane, body, force));
  PetscFunctionReturn(0);
}

PetscErrorCode FreeBodies::advance_body(std::size_t b, const Step &step, const Field &velocity, long *unresolved) {
  PetscFunctionBeginUser;
  Body &body = bodies_[b];
  const int dimension = body.box.dimension();
  const bool is_membrane = body.phase.material.is_membrane();
  const int own = is_membrane ? MembraneMechanics::work_fields + dimension : stage_fields(body.phase);
  Field memory = scratch(body.box, dimension + own), flow = memory.part(0, dimension),
        work = memory.part(dimension, own);
  bring_velocity(b, step, velocity, &flow);
  PetscCall(move(body.box, step, flow, work, &body.phase));
  move_receptors(body.box, step.dt, flow, body.phase, &body.receptors);
  if (is_membrane) PetscCall(move_membrane(step, flow, &body, work, unresolved));
  PetscFunctionReturn(0);
}

PetscErrorCode FreeBodies::advance(const Step &step, const Field &velocity, long *unresolved) {
  PetscFunctionBeginUser;
  *unresolved = 0;
  net_force_ = NetForce(*domain_, drifts_);
  PetscCall(exchange_.fetch(velocity));
  std::vector<long> found(bodies_.size(), 0);
  PetscCall(for_bodies([&](std::size_t b) { return advance_body(b, step, velocity, &found[b]); }));
  *unresolved = std::accumulate(found.begin(), found.end(), 0L);
  bool changed = false;
  PetscCall(fit_boxes(&changed, unresolved));
  if (changed) {
    PetscCall(find_forces());
    PetscFunctionReturn(0);
  }
  PetscCall(for_bodies([this](std::size_t b) {
    return bodies_[b].phase.material.is_membrane() ? PetscErrorCode(0) : find_force(&bodies_[b]);
  }));
  PetscCall(net_force_.compute_mean(&mean_force_));
  PetscFunctionReturn(0);
}

PetscErrorCode FreeBodies::start_membranes() {
  PetscFunctionBeginUser;
  for (Body &body : bodies_) {
    if (!body.phase.material.is_membrane()) continue;
    MembraneMechanics membrane({&body.box, sides_, nullptr});
    Field work = scratch(body.box, MembraneMechanics::work_fields);
    PetscCall(membrane.find(body.phase, work));
    PetscCall(membrane.start(&body.phase));
  }
  fitted_ = false;
  PetscFunctionReturn(0);
}

PetscErrorCode FreeBodies::place_markers() {
  PetscFunctionBeginUser;
  for (Body &body : bodies_) {
    if (!has_markers(body.phase.material) || !body.markers.empty()) continue;
    MembraneMechanics membrane({&body.box, sides_, nullptr});
    Field work = scratch(body.box, MembraneMechanics::work_fields);
    PetscCall(membrane.find(body.phase, work));
    SurfaceMarkers(body.box).place(membrane.surface(), membrane.surface_fields(), body.phase, body.species, 0,
                                   &body.markers);
  }
  PetscFunctionReturn(0);
}

PetscErrorCode FreeBodies::reset_unresolved(const std::vector<double> &trace, long *count) {
  PetscFunctionBeginUser;
  *count = 0;
  bool any = false;
  for (const double most : trace) any = any || may_be_unresolved(most, domain_->dimension());
  if (!any) PetscFunctionReturn(0);
  for (Body &body : bodies_) {
    if (!body.phase.material.elastic() || !may_be_unresolved(trace[body.species], domain_->dimension())) continue;
    const long found = eulastic::reset_unresolved(body.box, body.phase);
    if (found > 0) {
      PetscCall(extend(&body));
      PetscCall(find_force(&body));
    }
    *count += found;
  }
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, count, 1, MPI_LONG, MPI_SUM, domain_->comm()));
  PetscFunctionReturn(0);
}

PetscErrorCode FreeBodies::add_forces(const std::vector<WeightedTarget> &targets) {
  PetscFunctionBeginUser;
  std::vector<BoxExchange::Contribution> forces;
  for (const Body &body : bodies_) forces.push_back({&body.force, &body.forced()});
  PetscCall(exchange_.add(forces, targets));
  PetscFunctionReturn(0);
}

}  // namespace eulastic
