// Solver: rigid bodies in the projection, and what the fluid exerts on them.
#include "physics/momentum.hpp"
#include "physics/species_force.hpp"
#include "physics/viscous_stress.hpp"
#include "solver/solver.hpp"

namespace eulastic {

void Solver::respect_rigid(double time, double dt, const FieldBlock &increment, FieldBlock &velocity) const {
  if (!rigid_) return;
  if (!spec_.acm_of_the_paper()) correct_cut_faces(*grid_, *rigid_, dt / spec_.fluid.density, increment, velocity);
  impose_rigid_motion(*grid_, *rigid_, time, velocity);
}

PetscErrorCode Solver::rigid_loads(std::vector<RigidLoad> *loads) {
  PetscFunctionBeginUser;
  loads->clear();
  if (!rigid_) PetscFunctionReturn(0);
  const std::vector<Phase> *phases = nullptr;
  PetscCall(phases_now(&phases));
  Fluid fluid = spec_.fluid;
  const Real3 force = fluid.body_force.at(now_.time);
  const FieldBlock *viscosity = nullptr;
  PetscCall(viscosity_now(&viscosity));
  if (viscosity) fluid.viscosity = 0;
  WorkSpace::Lease rate;
  PetscCall(work_->take("loads on rigid bodies", grid_->dimension(), &rate));
  FieldBlock none;
  PetscCall(momentum_rate(*grid_, fluid, {now_.time, now_.dt, speed_scale(now_.dt > 0 ? now_.dt : 1), {}},
                          now_.velocity, now_.pressure, *phases, none, rate.fields()));
  add_species_forces(*grid_, *phases, now_.time, 1, rate.fields());
  if (viscosity) PetscCall(add_viscous_force(*grid_, *viscosity, 1, now_.velocity, rate.fields()));
  PetscCall(measure_rigid_loads(*grid_, *rigid_, spec_.fluid, now_.time, now_.velocity, now_.pressure, rate.fields(),
                                force, loads));
  PetscFunctionReturn(0);
}

}  // namespace eulastic
