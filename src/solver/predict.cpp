// Solver: v*, (7), by plain Euler or in viscous stages.
#include "field/open_sides.hpp"
#include "physics/species_force.hpp"
#include "physics/viscous_stress.hpp"
#include "solver/solver.hpp"

namespace eulastic {

PetscErrorCode Solver::predict(double dt) {
  PetscFunctionBeginUser;
  Fluid fluid = spec_.fluid;
  if (viscosity_) {
    PetscCall(compute_viscosity(*domain_, fluid, spec_.sides, now_.phases, &viscosity_));
    fluid.viscosity = 0;  // the stress of the varying one is added
  }
  MomentumStep step{now_.time, dt, speed_scale(dt), {}};
  if (loads_) PetscCall(begin_loads(dt));
  fill_ghosts_of_given_pressure(*domain_, sides_now(), now_.time + (spec_.staggered() ? 0.5 : 1) * dt, fluid.density,
                                now_.velocity, now_.pressure[0]);
  if (spec_.staggered()) {
    step.force_time += 0.5 * dt;
    if (now_.dt > 0) step.weights = {1 + 0.5 * dt / now_.dt, -0.5 * dt / now_.dt};  // Adams-Bashforth 2
  }
  if (rigid_impulse_) rigid_impulse_->begin(now_.time, dt, step.force_time, now_.velocity);
  PetscCall(spec_.explicit_predictor() ? predict_explicitly(fluid, step) : predict_in_stages(fluid, step));
  if (rigid_impulse_) rigid_impulse_->add_prediction(now_.velocity, velocity_star_);
  if (rigid_) impose_rigid_motion(*domain_, rigid_->faces(), now_.time + dt, velocity_star_);
  PetscFunctionReturn(0);
}

// The stress of a viscosity that varies. Cut faces of rigid bodies have had theirs.
PetscErrorCode Solver::add_local_viscous_force(double scale, Field &to) {
  std::vector<double> cut;
  PetscFunctionBeginUser;
  if (!viscosity_) PetscFunctionReturn(0);
  if (rigid_) cut = cut_face_values(*domain_, rigid_->faces(), to);
  PetscCall(add_viscous_force(*domain_, viscosity_, scale, now_.velocity, to));
  if (rigid_) set_cut_face_values(*domain_, rigid_->faces(), cut, to);
  PetscFunctionReturn(0);
}

// `fluid`: without viscosity where that varies, here and below.
PetscErrorCode Solver::predict_explicitly(const Fluid &fluid, const MomentumStep &step) {
  PetscFunctionBeginUser;
  PetscCall(predict_velocity(*domain_, fluid, step, now_.velocity, now_.pressure, now_.phases, velocity_star_));
  if (rigid_ && fluid.inertia)
    advect_from_surfaces(*domain_, rigid_->faces(), now_.time, weno_epsilon(step.speed_scale), step.dt, now_.velocity,
                         nullptr, velocity_star_);
  if (surface_tension_)
    PetscCall(surface_tension_->add_force(now_.phases, step.dt / fluid.density, true, velocity_star_));
  add_species_forces(*domain_, now_.phases, step.force_time, step.dt, velocity_star_);
  if (rigid_)
    see_rigid_surfaces_at_once(*domain_, rigid_->faces(), spec_.fluid.kinematic_viscosity(),
                               fluid.kinematic_viscosity(), now_.time, step.dt, now_.velocity, velocity_star_);
  PetscCall(add_local_viscous_force(step.dt, velocity_star_));
  ++stages_;
  PetscFunctionReturn(0);
}

PetscErrorCode Solver::predict_in_stages(const Fluid &fluid, const MomentumStep &step) {
  PetscFunctionBeginUser;
  const double dt = step.dt, nu = spec_.fluid.kinematic_viscosity();
  ForceSlope slope;
  if (!now_.phases.empty() && spec_.linear_force()) slope = {&slope_, 1 / (0.5 * (now_.dt + dt))};
  const int dim = domain_->dimension();
  WorkSpace::Lease rate, before;
  PetscCall(work_->take("rate of momentum", dim, &rate));
  PetscCall(work_->take("viscous stage before", dim, &before));
  PetscCall(momentum_rate(*domain_, fluid, step, now_.velocity, now_.pressure, now_.phases, now_.advection,
                          rate.fields(), slope));
  if (has_boxed()) {
    std::vector<BoxExchange::Target> targets{{&rate.fields(), 1}};
    if (slope.field) targets.push_back({slope.field, slope.factor});
    PetscCall(boxed_->add_forces(targets));
    take_off_mean(*domain_, boxed_->mean_force(), rate.fields());
  }
  if (rigid_ && fluid.inertia)
    advect_from_surfaces(*domain_, rigid_->faces(), now_.time, weno_epsilon(step.speed_scale), step.weights.now,
                         now_.velocity, now_.advection ? &now_.advection : nullptr, rate.fields());
  if (surface_tension_)
    PetscCall(surface_tension_->add_force(now_.phases, 1 / fluid.density, true, rate.fields(), slope));
  if (membranes_) PetscCall(membranes_->add_force(now_.phases, 1 / fluid.density, true, rate.fields(), slope));
  add_species_forces(*domain_, now_.phases, step.force_time, 1, rate.fields());
  std::vector<BoxExchange::Target> pulled{{&rate.fields(), 1 / fluid.density}};
  if (slope.field) pulled.push_back({slope.field, slope.factor / fluid.density});
  PetscCall(add_stretch_forces(before.part(0, 1), pulled));
  if (rigid_)
    see_rigid_surfaces(*domain_, rigid_->faces(), nu, fluid.kinematic_viscosity(), now_.time, dt, now_.velocity,
                       rate.fields(), slope_ ? &slope_ : nullptr);
  PetscCall(add_local_viscous_force(1, rate.fields()));
  SuperTimeStepping viscous{rate.part(0, dim), {}, velocity_star_.part(0, dim), before.part(0, dim)};
  std::vector<char> stressed;
  if (slope_) {
    viscous.slope = slope_.part(0, dim);
    stressed = stressed_rows(*domain_, now_.phases);
    boxed_->mark_rows(&stressed);
  }
  int stages = 1;
  RigidMeans *means = rigid_impulse_ ? rigid_impulse_->means() : nullptr;
  if (spec_.viscous == ViscousScheme::rkl) stages = rkl_stages(dt, limits(FlowExtremes{}).viscous);
  if (viscosity_)
    PetscCall(super_time_step(*domain_, *exchange_, spec_.sides, viscosity_, now_.time, dt, stages, now_.velocity,
                              viscous, velocity_star_, rigid(), nu, means));
  else
    PetscCall(super_time_step(*domain_, *exchange_, spec_.sides, fluid.kinematic_viscosity(), now_.time, dt, stages,
                              stressed, now_.velocity, viscous, velocity_star_, rigid(), means));
  stages_ += stages;
  PetscFunctionReturn(0);
}

}  // namespace eulastic
