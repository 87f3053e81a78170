#include "solver/fast_step.hpp"

#include "field/open_boundaries.hpp"
#include "flow/implicit_viscosity.hpp"
#include "flow/momentum.hpp"
#include "flow/projection.hpp"
#include "flow/super_time_stepping.hpp"
#include "solids/elastic_force.hpp"

#include <algorithm>
#include <cmath>

namespace eulastic {

FastStep::FastStep(Flow *flow, Projection *projection) : Scheme(flow, projection) {}
FastStep::~FastStep() = default;

std::size_t FastStep::bytes() const { return Scheme::bytes() + (implicit_ ? implicit_->bytes() : 0); }

PetscErrorCode FastStep::start() {
  State &now = flow_.now;
  const int dim = flow_.domain.dimension();
  PetscFunctionBeginUser;
  PetscCall(Scheme::start());
  if (flow_.spec.implicit_viscosity(bool(viscosity_), flow_.rigid)) {
    const ViscosityContrast range = contrast({});
    implicit_ = std::make_unique<ImplicitViscosity>();
    PetscCall(implicit_->create(flow_.domain, flow_.spec.sides, range.least / flow_.fluid.density,
                                range.most / flow_.fluid.density, flow_.spec.viscous_tolerance));
  }
  if (now.phases.empty() || !flow_.spec.linear_force()) PetscFunctionReturn(0);
  flow_.velocity_star = {};
  Field memory(flow_.domain, 3 * dim);
  std::copy_n(now.velocity.data(), flow_.domain.layout().size * dim, memory.data());
  now.velocity = memory.part(0, dim);
  flow_.slope = memory.part(dim, dim);
  flow_.velocity_star = memory.part(2 * dim, dim);
  flow_.memory = std::move(memory);
  PetscFunctionReturn(0);
}

PetscErrorCode FastStep::step(double dt, const Observer &in_middle, const Observer &with_pressure) {
  const State &now = flow_.now;
  const double to_middle = 0.5 * (now.dt + dt);
  PetscFunctionBeginUser;
  for (FlowPart *part : flow_.parts) PetscCall(part->begin_step());
  PetscCall(begin_slope(to_middle));
  PetscCall(move_bodies(to_middle));  // (4), (5)
  PetscCall(in_middle());
  if (now.pressure_before) extrapolate_pressure(dt);
  for (FlowPart *part : flow_.parts) PetscCall(part->prepare(dt));
  PetscCall(predict(dt));                             // (7)
  PetscCall(project(dt, rotation(), with_pressure));  // (8) to (10)
  PetscCall(end_step(dt));
  PetscFunctionReturn(0);
}

// Stores minus the forces per mass at the old positions of bodies, divided by dt; adding the new ones yields their rate
// of change.
PetscErrorCode FastStep::begin_slope(double dt) {
  PetscFunctionBeginUser;
  if (!flow_.slope) PetscFunctionReturn(0);
  PetscCall(compute_elastic_force(flow_.domain, -1 / (dt * flow_.fluid.density), flow_.now.phases, flow_.slope));
  for (FlowPart *part : flow_.parts) PetscCall(part->begin_slope(dt, flow_.slope));
  PetscFunctionReturn(0);
}

// Extrapolates the pressure linearly to the middle of the step. An error of the pressure drives a flow only where
// viscosity varies or beside bodies, and there it takes several steps to decay, so that with the last pressure the
// velocity would lag by a few steps (docs/method.md, section 16).
void FastStep::extrapolate_pressure(double dt) {
  State &state = flow_.now;
  const double interval = state.dt > 0 ? 0.5 * (state.dt + dt) : 0;
  const double ratio = state.pressure_interval > 0 ? interval / state.pressure_interval : 0;
  double *now = state.pressure.data(), *before = state.pressure_before.data();
  const std::size_t size = state.pressure.layout().size;
#pragma omp simd
  for (std::size_t i = 0; i < size; ++i) {
    const double p = now[i];
    now[i] = p + ratio * (p - before[i]);
    before[i] = p;
  }
  state.pressure_interval = interval;
}

PetscErrorCode FastStep::predict(double dt) {
  State &now = flow_.now;
  Fluid fluid;
  PetscFunctionBeginUser;
  PetscCall(find_viscosity(&fluid));
  MomentumStep step{now.time + 0.5 * dt, dt, flow_.speed_scale(dt), {}};
  if (now.dt > 0) step.weights = {1 + 0.5 * dt / now.dt, -0.5 * dt / now.dt};  // Adams-Bashforth 2
  fill_ghosts_of_given_pressure(flow_.domain, flow_.sides_now(), step.force_time, fluid.inertial_density(),
                                now.velocity, now.pressure[0]);
  for (FlowPart *part : flow_.parts) PetscCall(part->begin_rate(step));
  WeightedTarget slope;
  if (flow_.slope) slope = {&flow_.slope, 1 / (0.5 * (now.dt + dt))};
  PetscCall(advance_viscous_stages(fluid, step, slope));
  PetscFunctionReturn(0);
}

// Advances the velocity to v* by super time stepping of the viscosity; all other terms of the rate are constant in it.
PetscErrorCode FastStep::advance_viscous_stages(const Fluid &fluid, const MomentumStep &step,
                                                const WeightedTarget &slope) {
  const Domain &domain = flow_.domain;
  const BoundaryConditions &sides = flow_.spec.sides;
  State &now = flow_.now;
  const int dim = domain.dimension();
  WorkSpace::Lease rate, before;
  PetscFunctionBeginUser;
  PetscCall(flow_.work.lease("rate of momentum", dim, &rate));
  PetscCall(
      momentum_rate(domain, fluid, step, now.velocity, now.pressure, now.phases, now.advection, rate.fields(), slope));
  const MomentumRate all{
      step, 1, rate.fields(), now.advection ? &now.advection : nullptr, slope, fluid.kinematic_viscosity()};
  for (FlowPart *part : flow_.parts) PetscCall(part->add_rate(all));
  for (FlowPart *part : flow_.parts) PetscCall(part->close_rate(all));
  PetscCall(add_local_viscous_force(1, rate.fields()));
  PetscCall(flow_.work.lease("viscous stage before", dim, &before));
  SuperTimeStepping viscous{rate.part(0, dim), {}, flow_.velocity_star.part(0, dim), before.part(0, dim)};
  const int stages = flow_.spec.explicit_viscosity() ? 1 : rkl_stages(step.dt, limits(FlowExtremes{}).viscous);
  ViscousStep viscous_step{sides,
                           now.time,
                           step.dt,
                           stages,
                           now.velocity,
                           flow_.fluid.kinematic_viscosity(),
                           viscosity_ ? &viscosity_ : nullptr};
  if (flow_.slope) {
    viscous.slope = flow_.slope.part(0, dim);
    viscous_step.stressed = stressed_rows(domain, now.phases);
    for (const FlowPart *part : flow_.parts) part->mark_forced_rows(&viscous_step.stressed);
  }
  viscous_step.rigid = flow_.rigid;
  viscous_step.means = flow_.rigid_means;
  if (implicit_) {
    PetscCall(implicit_->step(flow_.exchange, viscous_step, viscous.rate, flow_.slope ? &viscous.slope : nullptr,
                              flow_.velocity_star));
    stages_ += implicit_->products();
    PetscFunctionReturn(0);
  }
  PetscCall(super_time_step(domain, flow_.exchange, viscous_step, viscous, flow_.velocity_star));
  stages_ += stages;
  PetscFunctionReturn(0);
}

// Factor of the divergence in the rotational update: the viscous force of dt grad(delta p) is nu div, or 4/3 of it with
// the deviatoric stress in 3-D, and half of it if the step begins with the last pressure. In a body much more viscous
// than the fluid only the fluid resists a dilation, so that the body's viscosity would turn p into noise there; with
// the least viscosity of the flow this does not happen at any contrast.
RotationalUpdate FastStep::rotation() const {
  const bool extrapolates = static_cast<bool>(flow_.now.pressure_before);
  if (!viscosity_) return {(extrapolates ? 1 : 0.5) * flow_.fluid.kinematic_viscosity(), 0};
  const ViscosityContrast range = contrast({});
  const double factor = flow_.domain.dimension() == 3 ? 4. / 3 : 1;
  // After an implicit viscous step a share above .91 would make modes of the extrapolated pressure grow.
  const double share = implicit_ ? std::sqrt(0.5) : 1;
  if (extrapolates) return {share * factor * range.least / flow_.fluid.density, 0};
  if (range.within(5)) return {0, factor / 2};
  return {factor / 2 * range.least / flow_.fluid.density, 0};
}

}  // namespace eulastic
