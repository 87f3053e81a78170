// Solver: the flow at the start, and bodies, where volume crosses sides of the box.
#include "base/exact_sum.hpp"
#include "bodies/labels.hpp"
#include "field/open_sides.hpp"
#include "flow/correction.hpp"
#include "flow/divergence.hpp"
#include "flow/momentum.hpp"
#include "openings/body_copy.hpp"
#include "openings/leaving.hpp"
#include "solver/solver.hpp"

#include <algorithm>
#include <cmath>

namespace eulastic {
namespace {

// What comes in changes by per time.
BoxSides rates_of(const BoxSides &sides, double time) {
  BoxSides rates = sides;
  for (auto &pair : rates)
    for (Side &side : pair) side.given = {side.given.rate(time), 0, 0, {}};  // at the start nothing is fed
  return rates;
}

// What stays where it is, or cannot be followed.
bool is_held(const Phase &phase) { return !phase.label || phase.material.attached || phase.material.is_rigid(); }

}  // namespace

// Bodies flow out through open sides, or leave whole when they come there. At the start they may not be there.
PetscErrorCode Solver::check_sides(bool start) {
  // What is held and where, whether any leave whole, whether any flow out; of bodies in boxes, whether any leave.
  int found[4] = {-1, 0, 0, 0};
  std::vector<std::size_t> leaving;
  const auto hold = [&](int phase, int d, bool high) { found[0] = std::max(found[0], phase * 6 + 2 * d + high); };
  PetscFunctionBeginUser;
  const std::vector<BodyInBox> boxed = boxed_->list();
  for (std::size_t b = 0; b < boxed.size(); ++b) {
    const BodyInBox &body = boxed[b];
    for (const auto [d, high] : domain_->sides())
      if (const SideKind kind = spec_.sides[d][high].kind; volume_crosses(kind) && (start || !is_open(kind)))
        if (has_solid(*body.box, body.phase->fraction[0], d, high, free_layers, BodyCells::threshold))
          hold(body.species, d, high);
    if (!start && leaves_box(body)) leaving.push_back(b);
  }
  found[3] = !leaving.empty();
  for (int p = 0; p < static_cast<int>(now_.phases.size()); ++p)
    for (const auto [d, high] : domain_->sides()) {
      const SideKind kind = spec_.sides[d][high].kind;
      if (now_.phases[p].material.is_rigid() || now_.phases[p].boxed || !volume_crosses(kind)) continue;
      const bool stops = start || !is_open(kind) || is_held(now_.phases[p]);
      if (!has_solid(*domain_, now_.phases[p].fraction[0], d, high, free_layers, stops ? BodyCells::threshold : 0))
        continue;
      if (stops)
        hold(p, d, high);
      else
        found[leave_whole(now_.phases[p].material) ? 1 : 2] = 1;
    }
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, found, 4, MPI_INT, MPI_MAX, domain_->comm()));
  const int held = found[0];
  if (held >= 0)
    crowded_ = "-species " + now_.phases[held / 6].species + ": solid within " + std::to_string(free_layers) +
               " cells of side " + "xyz"[held % 6 / 2] + (held % 2 ? "max" : "min") +
               ", which volume crosses; accepted: bodies that stay further inside, or a longer box";
  if (held < 0 && found[3] > 0) PetscCall(take_out_boxed(leaving));
  if (held < 0 && found[1] > 0) PetscCall(take_out_bodies(true));
  if (held < 0 && found[2] > 0 && now_.travel == 0) PetscCall(take_out_bodies(false));  // labels are new
  PetscFunctionReturn(0);
}

// Bodies of this rank in boxes, by their places in the list. They are last known where they are now.
PetscErrorCode Solver::take_out_boxed(const std::vector<std::size_t> &leaving) {
  std::vector<std::pair<int, Int3>> last;
  PetscFunctionBeginUser;
  const std::vector<BodyInBox> all = boxed_->list();
  for (const std::size_t b : leaving) {
    Int3 middle = all[b].phase->extent(*all[b].box).middle();
    for (int d = 0; d < 3; ++d) middle[d] += all[b].box->layout().begin[d];
    last.emplace_back(all[b].number, middle);
  }
  forget_looks();
  boxed_->remove(leaving);
  PetscCall(boxed_->follow());
  PetscCall(show_fractions(boxed_->list(), &now_.phases));
  PetscCall(bodies_.set_last_references(*domain_, last));
  PetscFunctionReturn(0);
}

// Those that leave whole, or the others of which no more is left than is beside the side.
PetscErrorCode Solver::take_out_bodies(bool whole) {
  std::map<int, Leaving> leaves;
  BodyOwners owners;
  std::vector<Int3> references;
  const auto concerned = [&](const Phase &phase) { return !is_held(phase) && leave_whole(phase.material) == whole; };
  // All ranks with cells of a body learn the last that any says of it.
  const auto agree = [&] {
    std::vector<double> here, owned(static_cast<std::size_t>(owners.owned().size()), 0);
    PetscFunctionBeginUser;
    for (const int body : owners.here()) here.push_back(leaves.count(body + 1) ? double(leaves[body + 1]) : 0);
    PetscCall(owners.reduce(1, MPI_MAX, here, &owned));
    PetscCall(owners.bring(1, owned, &here));
    for (std::size_t n = 0; n < here.size(); ++n)
      if (here[n] > 0) leaves[owners.here()[n] + 1] = static_cast<Leaving>(static_cast<int>(here[n]));
    PetscFunctionReturn(0);
  };
  PetscFunctionBeginUser;
  for (Phase &phase : now_.phases) {
    if (!concerned(phase)) continue;
    if (whole) PetscCall(carry_labels(*domain_, *exchange_, &phase));
    for (const auto [d, high] : domain_->sides())
      if (domain_->is_open(d, high)) mark_leaving(*domain_, d, high, free_layers, whole, &phase, &leaves);
  }
  PetscCall(bodies_.connect(*domain_, now_.phases, {}, &owners, &references));
  PetscCall(agree());
  if (!whole) {
    for (const Phase &phase : now_.phases)
      if (concerned(phase)) mark_staying(*domain_, free_layers, phase, &leaves);
    PetscCall(agree());
    int any = std::any_of(leaves.begin(), leaves.end(), [](const auto &of) { return of.second == Leaving::leaves; });
    PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &any, 1, MPI_INT, MPI_MAX, domain_->comm()));
    if (!any) PetscFunctionReturn(0);
  }
  for (Phase &phase : now_.phases) {
    if (!concerned(phase)) continue;
    take_out(*domain_, leaves, &phase);
    PetscCall(settle(phase));
  }
  if (whole && membranes_) PetscCall(membranes_->follow(&now_.phases, &now_.markers));
  PetscFunctionReturn(0);
}

namespace {

// In a cell at the surfaces of two bodies that touch fractions may add up to more than 1.
constexpr double full = 1.5;

bool lies_in_domain(const Box &block) {
  bool inside = true;
  for (int d = 0; d < block.dimension(); ++d) {
    const int begin = block.layout().begin[d], end = begin + block.cells()[d];
    inside = inside && (!block.is_wall(d) || (begin >= 0 && end <= block.domain_cells()[d]));
  }
  return inside;
}

}  // namespace

PetscErrorCode Solver::sum_fractions(Field *sum) {
  std::vector<Phase> shown(now_.phases.size());
  std::map<int, Phase *> boxed;
  PetscFunctionBeginUser;
  *sum = Field(*domain_, 1);
  for (std::size_t p = 0; p < now_.phases.size(); ++p) {
    if (!now_.phases[p].boxed) continue;
    shown[p].fraction = Field(*domain_, 1);
    boxed[static_cast<int>(p)] = &shown[p];
  }
  PetscCall(boxed_->show_fractions(boxed_->list(), boxed));
  for (std::size_t p = 0; p < now_.phases.size(); ++p) {
    const Phase &phase = now_.phases[p].boxed ? shown[p] : now_.phases[p];
    const ConstView phi = phase.fraction[0];
    for_points(domain_->rows(), [&, to = (*sum)[0]](int i, int j, int k) { to(i, j, k) += phi(i, j, k); });
  }
  PetscFunctionReturn(0);
}

// All see the same fractions: bodies of one stretch come in as far from each other as they are.
PetscErrorCode Solver::find_coming(const std::vector<int> &labels, std::vector<Coming> *states) {
  Field fractions;
  PetscFunctionBeginUser;
  PetscCall(sum_fractions(&fractions));
  struct Candidate {
    std::size_t which;  // of the labels
    BodyInBox body;
    Box block;  // where it would be
  };
  std::vector<Candidate> candidates;
  states->assign(labels.size(), Coming::has_left);
  for (const BodyInBox &body : boxed_->list()) {
    const auto found = std::find(labels.begin(), labels.end(), body.number);
    if (found == labels.end()) continue;
    const std::size_t n = found - labels.begin();
    const Box here = body.phase->block(*body.box, 0, 0);
    Int3 begin = here.layout().begin;
    for (int d = 0; d < 3; ++d) begin[d] += feeders_->shift_of(body.number)[d];
    const Box block(domain_->domain_shape(), begin, here.cells(), 0);
    (*states)[n] = Coming::waits;
    if (lies_in_domain(block)) candidates.push_back({n, body, block});
  }
  std::vector<BoxExchange::NumberedBox> numbered;
  for (const Candidate &one : candidates) numbered.push_back({&one.block, one.body.number});
  BoxExchange exchange(*domain_, 1);
  PetscCall(exchange.connect(numbered));
  PetscCall(exchange.fetch(fractions));
  for (std::size_t c = 0; c < candidates.size(); ++c) {
    const auto &[n, body, block] = candidates[c];
    const Int3 first = body.phase->extent(*body.box).begin;
    const ConstView own = body.phase->fraction[0];
    Field there(block, 1);
    exchange.copy_to_box(c, fractions, there);
    double fullest = 0;
    for_points(block.rows(), [&](int i, int j, int k) {
      const double phi = own(first[0] + i, first[1] + j, first[2] + k);
      if (phi > BodyCells::threshold) fullest = std::max(fullest, phi + there[0](i, j, k));
    });
    if (fullest <= full) (*states)[n] = Coming::comes_in;
  }
  PetscFunctionReturn(0);
}

PetscErrorCode Solver::feed_boxed(const std::vector<int> &labels) {
  std::vector<Coming> own, states;
  PetscFunctionBeginUser;
  PetscCall(find_coming(labels, &own));
  states = own;
  PetscCallMPI(
      MPI_Allreduce(MPI_IN_PLACE, states.data(), static_cast<int>(states.size()), MPI_INT, MPI_MAX, domain_->comm()));
  std::vector<std::pair<int, int>> copies;  // of this rank: label of the body, that of its copy
  std::map<int, Int3> shifts;
  for (std::size_t n = 0; n < labels.size(); ++n) {
    if (states[n] == Coming::waits) continue;
    if (states[n] == Coming::comes_in) {
      shifts[labels[n]] = feeders_->shift_of(labels[n]);
      PetscCall(bodies_.add_like(*domain_, labels[n], shifts[labels[n]]));
      feeders_->come_in(labels[n], bodies_.bodies());
      if (own[n] == Coming::comes_in) copies.emplace_back(labels[n], bodies_.bodies());
    }
    feeders_->forget(labels[n]);
  }
  for (const auto &[label, copy] : copies)
    PetscCall(boxed_->add_copy(label, copy, shifts[label], now_.phases[bodies_.species(label)]));
  if (shifts.empty()) PetscFunctionReturn(0);
  forget_looks();
  PetscCall(boxed_->follow());
  PetscCall(show_fractions(boxed_->list(), &now_.phases));
  PetscFunctionReturn(0);
}

// A body that has left its feeder comes in behind; where others fill its place it waits.
PetscErrorCode Solver::feed_bodies() {
  std::vector<int> all, passed, boxed;
  std::vector<BodyCopy> copies;
  PetscFunctionBeginUser;
  PetscCall(feeders_->find_passed(now_.phases, boxed_->list(), &all));
  for (const int label : all) (now_.phases[bodies_.species(label)].boxed ? boxed : passed).push_back(label);
  if (!boxed.empty()) PetscCall(feed_boxed(boxed));
  if (passed.empty()) PetscFunctionReturn(0);
  PetscCall(copy_bodies(*domain_, *exchange_, passed, &now_.phases, &copies));
  for (const BodyCopy &copy : copies) {
    if (copy.phase < 0) {  // it has left
      feeders_->forget(copy.label);
      continue;
    }
    const Int3 shift = feeders_->shift_of(copy.label);
    Field fractions;
    double fullest = 0;
    PetscCall(sum_fractions(&fractions));
    PetscCall(find_fullest(*domain_, copy, shift, fractions[0], &fullest));
    if (fullest > full) continue;
    PetscCall(bodies_.add_like(*domain_, copy.label, shift));
    feeders_->come_in(copy.label, bodies_.bodies());
    feeders_->forget(copy.label);
    Phase &phase = now_.phases[copy.phase];
    put_body(*domain_, copy, shift, bodies_.bodies(), &phase);
    PetscCall(settle(phase));
    if (phase.material.is_membrane())
      PetscCall(membranes_->place_markers(phase, copy.phase, bodies_.bodies(), &now_.markers));
  }
  PetscFunctionReturn(0);
}

Fluid Solver::driven_fluid() const {
  Fluid fluid = spec_.fluid;
  const Real3 drive = pressure_drive(spec_.sides, domain_->domain_shape().length, fluid.density);
  for (int d = 0; d < 3; ++d) fluid.body_force.force[d] = std::fabs(fluid.body_force.force[d]) + drive[d];
  for (const Phase &phase : now_.phases) {
    const BodyForce &own = phase.material.body_force;
    for (int d = 0; d < 3; ++d) fluid.body_force.force[d] += std::fabs(own.force[d]);
    if (own.acts()) fluid.body_force.frequency = std::max(fluid.body_force.frequency, own.frequency);
  }
  return fluid;
}

// v -= grad q and p += q for the q that makes v solenoidal, a velocity or how it changes in time; ghosts of v as given.
PetscErrorCode Solver::project_start(bool is_rate, Field &velocity, Field &pressure) {
  const double density = spec_.fluid.density;
  constexpr double dt = 1;
  const int times = spec_.pressure == PressureKind::acm && spec_.acm_of_the_paper() ? 200 : 1;
  WorkSpace::Lease of_velocity, increment;
  Field none(*domain_, 1);  // without a pressure its relaxation has nothing to do
  PetscFunctionBeginUser;
  PetscCall(work_->take("divergence", 1, &of_velocity));
  if (!pressure_solver_->formula()) PetscCall(work_->take("pressure increment", 1, &increment));
  Field &divergence = of_velocity.fields();
  pressure_solver_->set_target(0);
  for (int n = 0; n < times; ++n) {
    PetscCall(exchange_->update_ghosts(velocity, 1));
    PetscCall(compute_divergence(*domain_, density, velocity, divergence));
    PetscCall(exchange_->update_ghosts(divergence, 1));
    fill_ghosts_of_increment(*domain_, divergence[0], 1);
    PetscCall(pressure_solver_->solve(dt, divergence, none, increment.fields()));
    if (const kernels::AcmIncrement *formula = pressure_solver_->formula())
      PetscCall(correct_velocity(*domain_, density, dt, 0, *formula, divergence, velocity, none));
    else
      PetscCall(correct_velocity(*domain_, density, dt, 0, increment.fields(), divergence, velocity, none));
    respect_rigid(now_.time, dt, increment.fields(), velocity);
    if (rigid_ && is_rate) clear_rigid_faces(*domain_, rigid_->faces(), velocity);
    for (const Segment &row : domain_->rows()) {
      const double *q = none[0].row(row.j, row.k);
      double *p = pressure[0].row(row.j, row.k);
      for (int i = 0; i < row.i_end; ++i) p[i] += q[i];
    }
    none.clear();
  }
  PetscFunctionReturn(0);
}

// The first step would do both as well, with a pressure that grows as 1/dt; the next would start from that.
PetscErrorCode Solver::start_flow() {
  const int dim = domain_->dimension();
  double largest = 0;
  Field unused(*domain_, 1), rate(*domain_, dim), no_advection;
  PetscFunctionBeginUser;
  PetscCall(project_start(false, now_.velocity, unused));
  PetscCall(update_velocity_ghosts(now_.velocity, now_.time, Box::stencil_width));
  for_points(domain_->rows(),
             [&](int i, int j, int k) { largest = std::max(largest, std::fabs(now_.pressure[0](i, j, k))); });
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &largest, 1, MPI_DOUBLE, MPI_MAX, domain_->comm()));
  if (largest > 0) PetscFunctionReturn(0);  // of a file
  fill_ghosts_of_given_pressure(*domain_, spec_.sides, now_.time, spec_.fluid.density, now_.velocity, now_.pressure[0]);
  const MomentumStep now{now_.time, 1, speed_scale(1), {}};
  PetscCall(momentum_rate(*domain_, spec_.fluid, now, now_.velocity, now_.pressure, {}, no_advection, rate));
  for (int d = 0; d < dim; ++d)
    if (domain_->is_wall(d)) {
      close_wall_faces(*domain_, rate[d], d);
      set_inflow_faces(*domain_, rates_of(spec_.sides, now_.time), 0, rate[d], d);
    }
  const double nu = spec_.fluid.kinematic_viscosity();
  if (rigid_) see_rigid_surfaces(*domain_, rigid_->faces(), nu, nu, now_.time, 0, now_.velocity, rate, nullptr);
  PetscCall(project_start(true, rate, now_.pressure));
  PetscCall(update_centre_ghosts(now_.pressure, 1));
  PetscFunctionReturn(0);
}

// What is behind pressure sides takes part in a step.

namespace {

// Behind the side it stands on, a pressure of 1 there.
void raise_ghosts(const Box &box, int d, bool high, View pressure) {
  const std::ptrdiff_t inward = high ? -pressure.stride(d) : pressure.stride(d);
  const std::ptrdiff_t ghost = high ? 0 : -pressure.stride(d);  // of the cell above the face
  for_points(box.faces_on(d, high), [&](int i, int j, int k) {
    double *at = &pressure(i, j, k) + ghost;
    *at = 2 - at[inward];
  });
}

}  // namespace

PetscErrorCode Solver::measure_loads(const Field &velocity, std::vector<double> *flow) {
  ExactSums sums(loads_->count());
  PetscFunctionBeginUser;
  for (int n = 0; n < loads_->count(); ++n) {
    const auto [d, high] = loads_->side(n);
    const ConstView v = velocity[d];
    const int outward = high ? 1 : -1;
    for_points(domain_->faces_on(d, high), [&](int i, int j, int k) { sums.add(n, outward * v(i, j, k)); });
  }
  flow->resize(loads_->count());
  PetscCall(sums.reduce(domain_->comm(), flow->data()));
  for (int n = 0; n < loads_->count(); ++n)
    (*flow)[n] *= domain_->cell_volume() / domain_->spacing()[loads_->side(n)[0]];
  PetscFunctionReturn(0);
}

PetscErrorCode Solver::find_responses() {
  PetscFunctionBeginUser;
  for (int n = 0; n < loads_->count(); ++n) {
    const auto [d, high] = loads_->side(n);
    Field pressure(*domain_, 1), velocity(*domain_, domain_->dimension());
    const double push = (high ? -2 : 2) / (spec_.fluid.density * domain_->spacing()[d]);
    View v = velocity[d];
    for_points(domain_->faces_on(d, high), [&](int i, int j, int k) { v(i, j, k) = push; });
    if (rigid_) open_faces(*domain_, rigid_->faces(), velocity);
    PetscCall(project_start(true, velocity, pressure));
    PetscCall(exchange_->update_ghosts(pressure, 1));
    fill_ghosts_of_increment(*domain_, pressure[0], 1);
    raise_ghosts(*domain_, d, high, pressure[0]);
    std::vector<double> flow;
    PetscCall(measure_loads(velocity, &flow));
    loads_->set_response(n, std::move(pressure), flow);
  }
  PetscFunctionReturn(0);
}

PetscErrorCode Solver::begin_loads(double dt) {
  std::vector<double> flow;
  PetscFunctionBeginUser;
  PetscCall(measure_loads(now_.velocity, &flow));
  loads_->begin(spec_.sides, now_.time + (spec_.staggered() ? 0.5 : 1) * dt, dt, flow);
  PetscFunctionReturn(0);
}

PetscErrorCode Solver::settle_loads(double dt, const Field &divergence, Field &increment) {
  std::vector<double> flow;
  PetscFunctionBeginUser;
  PetscCall(measure_loads(velocity_star_, &flow));
  loads_->add_up(*domain_, loads_->settle(dt, flow), increment);
  if (rigid_impulse_) rigid_impulse_->add_increment(increment, obstacles_ != nullptr);
  PetscCall(
      correct_velocity(*domain_, spec_.fluid.density, dt, 0, increment, divergence, velocity_star_, now_.pressure));
  respect_rigid(now_.time + dt, dt, increment, velocity_star_);
  PetscFunctionReturn(0);
}

}  // namespace eulastic
