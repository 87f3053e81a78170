// Solver: the flow at the start, where volume crosses sides of the box.
#include "field/open_sides.hpp"
#include "physics/correction.hpp"
#include "physics/divergence.hpp"
#include "solver/solver.hpp"

#include <algorithm>

namespace eulastic {

Fluid Solver::driven_fluid() const {
  Fluid fluid = spec_.fluid;
  const Real3 drive = pressure_drive(spec_.sides, grid_->spec().length, fluid.density);
  for (int d = 0; d < 3; ++d) fluid.body_force.force[d] = std::fabs(fluid.body_force.force[d]) + drive[d];
  for (const Phase &phase : now_.phases) {
    const BodyForce &own = phase.material.body_force;
    for (int d = 0; d < 3; ++d) fluid.body_force.force[d] += std::fabs(own.force[d]);
    if (own.acts()) fluid.body_force.frequency = std::max(fluid.body_force.frequency, own.frequency);
  }
  return fluid;
}

// The first step would do it as well, with a pressure that grows as 1/dt; the next would start from that.
PetscErrorCode Solver::make_solenoidal() {
  constexpr double dt = 1;
  const int times = spec_.pressure == PressureKind::acm && spec_.acm_of_the_paper() ? 200 : 1;
  WorkSpace::Lease of_velocity, increment;
  FieldBlock pressure(*grid_, 1);
  PetscFunctionBeginUser;
  PetscCall(work_->take("divergence", 1, &of_velocity));
  if (!pressure_solver_->formula()) PetscCall(work_->take("pressure increment", 1, &increment));
  pressure_solver_->set_target(0);
  for (int n = 0; n < times; ++n) {
    PetscCall(compute_divergence(*grid_, spec_.fluid.density, now_.velocity, of_velocity.fields()));
    PetscCall(exchange_->update(of_velocity.fields(), 1));
    fill_ghosts_of_increment(*grid_, of_velocity.fields()[0], 1);
    PetscCall(pressure_solver_->solve(dt, of_velocity.fields(), pressure, increment.fields()));
    if (const kernels::AcmIncrement *formula = pressure_solver_->formula())
      PetscCall(correct_velocity(*grid_, spec_.fluid.density, dt, 0, *formula, of_velocity.fields(), now_.velocity,
                                 pressure));
    else
      PetscCall(correct_velocity(*grid_, spec_.fluid.density, dt, 0, increment.fields(), of_velocity.fields(),
                                 now_.velocity, pressure));
    if (rigid_ && !spec_.acm_of_the_paper())
      correct_cut_faces(*grid_, *rigid_, dt / spec_.fluid.density, increment.fields(), now_.velocity);
    if (rigid_) impose_rigid_motion(*grid_, *rigid_, now_.time, now_.velocity);
    PetscCall(update_velocity_ghosts(now_.velocity, now_.time, Grid::stencil_width));
    pressure.clear();  // its relaxation would go back to what has been
  }
  PetscFunctionReturn(0);
}

}  // namespace eulastic
