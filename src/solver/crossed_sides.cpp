// Solver: the flow at the start, and bodies, where volume crosses sides of the box.
#include "bodies/body_copy.hpp"
#include "bodies/colours.hpp"
#include "bodies/labels.hpp"
#include "bodies/leaving.hpp"
#include "bodies/near_bodies.hpp"
#include "field/open_sides.hpp"
#include "physics/correction.hpp"
#include "physics/divergence.hpp"
#include "physics/momentum.hpp"
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
  int found[3] = {-1, 0, 0};  // what is held and where, whether any leave whole, whether any flow out
  PetscFunctionBeginUser;
  for (int p = 0; p < static_cast<int>(now_.phases.size()); ++p)
    for (const auto [d, high] : domain_->sides()) {
      const SideKind kind = spec_.sides[d][high].kind;
      if (now_.phases[p].material.is_rigid() || !volume_crosses(kind)) continue;
      const bool stops = start || !is_open(kind) || is_held(now_.phases[p]);
      if (!has_solid(*domain_, now_.phases[p].fraction[0], d, high, free_layers, stops ? BodyCells::threshold : 0))
        continue;
      if (stops)
        found[0] = std::max(found[0], p * 6 + 2 * d + high);
      else
        found[leave_whole(now_.phases[p].material) ? 1 : 2] = 1;
    }
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, found, 3, MPI_INT, MPI_MAX, domain_->comm()));
  const int held = found[0];
  if (held >= 0)
    crowded_ = "-species " + now_.phases[held / 6].species + ": solid within " + std::to_string(free_layers) +
               " cells of side " + "xyz"[held % 6 / 2] + (held % 2 ? "max" : "min") +
               ", which volume crosses; accepted: bodies that stay further inside, or a longer box";
  if (held < 0 && found[1] > 0) PetscCall(take_out_bodies(true));
  if (held < 0 && found[2] > 0 && now_.travel == 0) PetscCall(take_out_bodies(false));  // labels are new
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

// A body that has left its feeder comes in behind, in a phase where nobody is near; where others fill its place it
// waits.
PetscErrorCode Solver::feed_bodies() {
  constexpr double full =
      1.5;  // in a cell at the surfaces of two bodies that touch fractions may add up to more than 1
  std::vector<int> passed;
  std::vector<BodyCopy> copies;
  PetscFunctionBeginUser;
  PetscCall(feeders_->find_passed(now_.phases, &passed));
  if (passed.empty()) PetscFunctionReturn(0);
  PetscCall(copy_bodies(*domain_, *exchange_, passed, &now_.phases, &copies));
  for (const BodyCopy &copy : copies) {
    if (copy.phase < 0) {  // it has left
      feeders_->forget(copy.label);
      continue;
    }
    const Int3 shift = feeders_->shift_of(copy.label);
    BodyRoom room;
    PetscCall(find_room(*domain_, copy, shift, contact_reach, now_.phases, &room));
    if (room.fullest > full) continue;
    int p = copy.phase;
    if (now_.phases[p].separate && room.near[p]) {
      const int phases = static_cast<int>(now_.phases.size());
      for (p = 0; p < phases; ++p)
        if (now_.phases[p].species == now_.phases[copy.phase].species && !room.near[p]) break;
      if (p == phases) add_colour(*domain_, copy.phase, &now_.phases);
    }
    PetscCall(bodies_.add_like(*domain_, copy.label, shift));
    feeders_->come_in(copy.label, bodies_.bodies());
    feeders_->forget(copy.label);
    put_body(*domain_, copy, shift, bodies_.bodies(), &now_.phases[p]);
    PetscCall(settle(now_.phases[p]));
    if (now_.phases[p].material.is_membrane())
      PetscCall(membranes_->place_markers(now_.phases[p], p, bodies_.bodies(), &now_.markers));
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

}  // namespace eulastic
