#include "solver/classic_step.hpp"

#include "field/open_boundaries.hpp"
#include "flow/momentum.hpp"
#include "flow/projection.hpp"

namespace eulastic {

PetscErrorCode ClassicStep::step(double dt, const Observer &, const Observer &with_pressure) {
  PetscFunctionBeginUser;
  for (FlowPart *part : flow_.parts) PetscCall(part->begin_step());
  for (FlowPart *part : flow_.parts) PetscCall(part->prepare(dt));
  PetscCall(predict(dt));                     // (7)
  PetscCall(project(dt, {}, with_pressure));  // (8), (9), (11) to (13)
  PetscCall(move_bodies(dt));                 // (4), (5)
  PetscCall(end_step(dt));
  PetscFunctionReturn(0);
}

PetscErrorCode ClassicStep::predict(double dt) {
  State &now = flow_.now;
  Field &velocity = flow_.velocity_star;
  Fluid fluid;
  PetscFunctionBeginUser;
  PetscCall(find_viscosity(&fluid));
  const MomentumStep step{now.time, dt, flow_.speed_scale(dt), {}};
  fill_ghosts_of_given_pressure(flow_.domain, flow_.sides_now(), now.time + dt, fluid.inertial_density(), now.velocity,
                                now.pressure[0]);
  for (FlowPart *part : flow_.parts) PetscCall(part->begin_rate(step));
  PetscCall(predict_velocity(flow_.domain, fluid, step, now.velocity, now.pressure, now.phases, velocity));
  const MomentumRate all{step, dt, velocity, nullptr, {}, fluid.kinematic_viscosity()};
  for (FlowPart *part : flow_.parts) PetscCall(part->add_rate(all));
  for (FlowPart *part : flow_.parts) PetscCall(part->close_rate(all));
  PetscCall(add_local_viscous_force(dt, velocity));
  ++stages_;
  PetscFunctionReturn(0);
}

}  // namespace eulastic
