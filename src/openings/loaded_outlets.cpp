#include "openings/loaded_outlets.hpp"

#include "base/exact_sum.hpp"
#include "field/open_boundaries.hpp"
#include "flow/correction.hpp"
#include "parts/state.hpp"
#include "rigid/rigid_surfaces.hpp"

namespace eulastic {
namespace {

// Behind the side it stands on, a pressure of 1 there.
void raise_ghosts(const Box &box, int d, bool high, View pressure) {
  const std::ptrdiff_t inward = high ? -pressure.stride(d) : pressure.stride(d);
  const std::ptrdiff_t ghost = high ? 0 : -pressure.stride(d);  // of the cell above the face
  for_points(box.boundary_faces(d, high), [&](int i, int j, int k) {
    double *at = &pressure(i, j, k) + ghost;
    *at = 2 - at[inward];
  });
}

}  // namespace

PetscErrorCode LoadedOutlets::carry(CarriedState *state) {
  PetscFunctionBeginUser;
  state->reals["outlet_loads"] = loads_.numbers();
  PetscFunctionReturn(0);
}

// Volume that leaves through loaded sides per time.
PetscErrorCode LoadedOutlets::measure(const Field &velocity, std::vector<double> *flow) const {
  const Domain &domain = flow_.domain;
  ExactSums sums(loads_.count());
  PetscFunctionBeginUser;
  for (int n = 0; n < loads_.count(); ++n) {
    const auto [d, high] = loads_.side(n);
    const ConstView v = velocity[d];
    const int outward = high ? 1 : -1;
    for_points(domain.boundary_faces(d, high), [&](int i, int j, int k) { sums.add(n, outward * v(i, j, k)); });
  }
  flow->resize(loads_.count());
  PetscCall(sums.reduce(domain.comm(), flow->data()));
  for (int n = 0; n < loads_.count(); ++n) (*flow)[n] *= domain.cell_volume() / domain.spacing()[loads_.side(n)[0]];
  PetscFunctionReturn(0);
}

// What a pressure of 1 on each side alone means for pressure and flow.
PetscErrorCode LoadedOutlets::start() {
  const Domain &domain = flow_.domain;
  PetscFunctionBeginUser;
  for (int n = 0; n < loads_.count(); ++n) {
    const auto [d, high] = loads_.side(n);
    Field pressure(domain, 1), velocity(domain, domain.dimension());
    const double push = (high ? -2 : 2) / (flow_.fluid.density * domain.spacing()[d]);
    View v = velocity[d];
    for_points(domain.boundary_faces(d, high), [&](int i, int j, int k) { v(i, j, k) = push; });
    if (flow_.rigid) scale_open_faces(domain, *flow_.rigid, velocity);
    PetscCall(projection_.make_solenoidal(true, velocity, pressure));
    PetscCall(flow_.exchange.update_ghosts(pressure, 1));
    fill_ghosts_of_increment(domain, pressure[0], 1);
    raise_ghosts(domain, d, high, pressure[0]);
    std::vector<double> flow;
    PetscCall(measure(velocity, &flow));
    loads_.set_response(n, std::move(pressure), flow);
  }
  PetscFunctionReturn(0);
}

// Pressures on the sides for a step.
PetscErrorCode LoadedOutlets::prepare(double dt) {
  std::vector<double> flow;
  PetscFunctionBeginUser;
  PetscCall(measure(flow_.now.velocity, &flow));
  loads_.begin(flow_.spec.sides, flow_.now.time + (flow_.staggered() ? 0.5 : 1) * dt, dt, flow);
  PetscFunctionReturn(0);
}

// And after it, with what the flow has become.
PetscErrorCode LoadedOutlets::end_projection(double dt, const Field &divergence, Field &increment) {
  std::vector<double> flow;
  PetscFunctionBeginUser;
  PetscCall(measure(flow_.velocity_star, &flow));
  loads_.add_up(flow_.domain, loads_.end(dt, flow), increment);
  for (FlowPart *part : flow_.parts) PetscCall(part->observe_increment(increment));
  PetscCall(correct_velocity(flow_.domain, flow_.fluid.density, dt, 0, increment, divergence, flow_.velocity_star,
                             flow_.now.pressure));
  for (FlowPart *part : flow_.parts) PetscCall(part->correct(flow_.now.time + dt, dt, increment, flow_.velocity_star));
  PetscFunctionReturn(0);
}

}  // namespace eulastic
