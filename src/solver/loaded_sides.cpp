// Solver: what is behind pressure sides takes part in a step.
#include "base/exact_sum.hpp"
#include "field/open_sides.hpp"
#include "physics/correction.hpp"
#include "solver/solver.hpp"

namespace eulastic {
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
