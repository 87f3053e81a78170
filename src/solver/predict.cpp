// Solver: v*, (7), by plain Euler or in viscous stages.
#include "field/open_sides.hpp"
#include "physics/momentum.hpp"
#include "physics/species_force.hpp"
#include "physics/viscous_stress.hpp"
#include "solver/solver.hpp"

namespace eulastic {

PetscErrorCode Solver::predict(double dt) {
  PetscFunctionBeginUser;
  Fluid fluid = spec_.fluid;
  const double nu = fluid.kinematic_viscosity();
  if (viscosity_) {
    PetscCall(compute_viscosity(*grid_, fluid, spec_.sides, now_.phases, &viscosity_));
    fluid.viscosity = 0;  // the stress of the varying one is added
  }
  MomentumStep step{now_.time, dt, speed_scale(dt), {}};
  if (loads_) PetscCall(begin_loads(dt));
  fill_ghosts_of_given_pressure(*grid_, sides_now(), now_.time + (spec_.staggered() ? 0.5 : 1) * dt, fluid.density,
                                now_.velocity, now_.pressure[0]);
  if (spec_.staggered()) {
    step.force_time += 0.5 * dt;
    if (now_.dt > 0) step.weights = {1 + 0.5 * dt / now_.dt, -0.5 * dt / now_.dt};  // Adams-Bashforth 2
  }
  if (spec_.explicit_predictor()) {
    PetscCall(predict_velocity(*grid_, fluid, step, now_.velocity, now_.pressure, now_.phases, velocity_star_));
    if (surface_tension_) PetscCall(surface_tension_->add_force(now_.phases, dt / fluid.density, true, velocity_star_));
    add_species_forces(*grid_, now_.phases, step.force_time, dt, velocity_star_);
    std::vector<double> cut;
    if (rigid_) {
      see_rigid_surfaces_at_once(*grid_, rigid_->faces(), nu, fluid.kinematic_viscosity(), now_.time, dt, now_.velocity,
                                 velocity_star_);
      cut = cut_face_values(*grid_, rigid_->faces(), velocity_star_);
    }
    if (viscosity_) PetscCall(add_viscous_force(*grid_, viscosity_, dt, now_.velocity, velocity_star_));
    if (rigid_) {
      set_cut_face_values(*grid_, rigid_->faces(), cut, velocity_star_);
      impose_rigid_motion(*grid_, rigid_->faces(), now_.time + dt, velocity_star_);
    }
    ++stages_;
    PetscFunctionReturn(0);
  }
  ForceSlope slope;
  if (!now_.phases.empty() && spec_.linear_force()) slope = {&slope_, 1 / (0.5 * (now_.dt + dt))};
  const int dim = grid_->dimension();
  WorkSpace::Lease rate, before;
  PetscCall(work_->take("rate of momentum", dim, &rate));
  PetscCall(work_->take("viscous stage before", dim, &before));
  PetscCall(momentum_rate(*grid_, fluid, step, now_.velocity, now_.pressure, now_.phases, now_.advection, rate.fields(),
                          slope));
  if (surface_tension_)
    PetscCall(surface_tension_->add_force(now_.phases, 1 / fluid.density, true, rate.fields(), slope));
  if (membranes_) PetscCall(membranes_->add_force(now_.phases, 1 / fluid.density, true, rate.fields(), slope));
  add_species_forces(*grid_, now_.phases, step.force_time, 1, rate.fields());
  PetscCall(add_stretch_forces(before.part(0, 1), rate.fields()));
  std::vector<double> cut;
  if (rigid_) {
    see_rigid_surfaces(*grid_, rigid_->faces(), nu, fluid.kinematic_viscosity(), now_.time, dt, now_.velocity,
                       rate.fields(), slope_ ? &slope_ : nullptr);
    cut = cut_face_values(*grid_, rigid_->faces(), rate.fields());
  }
  if (viscosity_) PetscCall(add_viscous_force(*grid_, viscosity_, 1, now_.velocity, rate.fields()));
  if (rigid_) set_cut_face_values(*grid_, rigid_->faces(), cut, rate.fields());
  SuperTimeStepping viscous{rate.part(0, dim), {}, velocity_star_.part(0, dim), before.part(0, dim)};
  if (slope_) viscous.slope = slope_.part(0, dim);
  int stages = 1;
  if (spec_.viscous == ViscousScheme::rkl) stages = rkl_stages(dt, limits(FlowExtremes{}).viscous);
  if (viscosity_)
    PetscCall(super_time_step(*grid_, *exchange_, spec_.sides, viscosity_, now_.time, dt, stages, now_.velocity,
                              viscous, velocity_star_, rigid(), nu));
  else
    PetscCall(super_time_step(*grid_, *exchange_, spec_.sides, fluid.kinematic_viscosity(), now_.time, dt, stages,
                              now_.phases, now_.velocity, viscous, velocity_star_, rigid()));
  if (rigid_) impose_rigid_motion(*grid_, rigid_->faces(), now_.time + dt, velocity_star_);
  stages_ += stages;
  PetscFunctionReturn(0);
}

}  // namespace eulastic
