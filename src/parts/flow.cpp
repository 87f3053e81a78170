#include "parts/flow.hpp"

#include "field/boundaries.hpp"
#include "field/open_boundaries.hpp"
#include "parts/flow_part.hpp"

#include <algorithm>
#include <cmath>

namespace eulastic {

bool Flow::drifts() const {
  for (int d = 0; d < domain.dimension(); ++d)
    for (const BoundaryCondition &side : spec.sides[d])
      if (domain.is_wall(d) && side.kind != BoundaryKind::symmetry) return false;
  return true;
}

PetscErrorCode Flow::carry(CarriedState *state) {
  PetscFunctionBeginUser;
  state->add_velocity("velocity", now.velocity);
  state->add_centred("pressure", now.pressure);
  state->add_centred("pressure_before", now.pressure_before);
  state->add_velocity("advection", now.advection);
  state->reals["time"] = {&now.time};
  state->reals["time_step"] = {&now.dt};
  state->reals["flow_scales"] = {&now.speed_scale, &now.crossing_rate, &now.travel_since_labels};
  if (now.pressure_before) state->reals["pressure_interval"] = {&now.pressure_interval};
  state->integers["step"] = {&now.step};
  if (now.forgotten > 0) state->integers["forgotten"] = {&now.forgotten};
  for (FlowPart *part : parts) PetscCall(part->carry(state));
  PetscFunctionReturn(0);
}

std::size_t Flow::bytes() const {
  std::size_t sum = now.velocity.bytes() + now.pressure.bytes() + now.pressure_before.bytes() + now.advection.bytes() +
                    velocity_star.bytes() + memory.bytes() + work.bytes();
  for (const FlowPart *part : parts) sum += part->bytes();
  return sum;
}

BoundaryConditions Flow::sides_now() const {
  BoundaryConditions sides = spec.sides;
  for (const FlowPart *part : parts) part->set_boundary_pressures(&sides);
  return sides;
}

PetscErrorCode Flow::update_velocity_ghosts(Field &velocity, double time, int width) {
  PetscFunctionBeginUser;
  PetscCall(exchange.update_ghosts(velocity, width));
  fill_wall_ghosts_velocity(domain, spec.sides, time, velocity, width);
  PetscFunctionReturn(0);
}

PetscErrorCode Flow::update_centre_ghosts(Field &field, int width) {
  PetscFunctionBeginUser;
  PetscCall(exchange.update_ghosts(field, width));
  fill_wall_ghosts_even(domain, at_centre, field[0], width);
  PetscFunctionReturn(0);
}

Fluid Flow::driven_fluid() const {
  Fluid driven = fluid;
  const Real3 drive = pressure_drive(spec.sides, domain.domain_shape().length, fluid.density);
  for (int d = 0; d < 3; ++d) driven.body_force.force[d] = std::fabs(driven.body_force.force[d]) + drive[d];
  for (const Phase &phase : now.phases) {
    const BodyForce &own = phase.material.body_force;
    for (int d = 0; d < 3; ++d) driven.body_force.force[d] += std::fabs(own.force[d]);
    if (own.acts()) driven.body_force.frequency = std::max(driven.body_force.frequency, own.frequency);
  }
  return driven;
}

double Flow::speed_scale(double dt) const {
  const Real3 f = driven_fluid().body_force.force, &h = domain.spacing();
  return std::max({now.speed_scale, dt * std::hypot(f[0], f[1], f[2]), 1e-6 * std::min(h[0], h[1]) / dt});
}

PetscErrorCode Flow::rebuild_derived_fields(Phase *phase) {
  PetscFunctionBeginUser;
  for (FlowPart *part : parts) PetscCall(part->rebuild_derived_fields(phase));
  PetscFunctionReturn(0);
}

PetscErrorCode Flow::find_rows(Phase *phase) {
  PetscFunctionBeginUser;
  constexpr double large_share = 0.25;
  const int ghosts = domain.spec().ghosts;
  PetscCall(phase->rows.find(domain, phase->fraction[0]));
  PetscCall(exchange.update_ghosts(phase->fraction, ghosts, &phase->rows));
  PetscCall(phase->rows.find(domain, phase->fraction[0]));  // now with the rows that other ranks occupy
  fill_wall_ghosts_even(domain, at_centre, phase->fraction[0], ghosts, &phase->rows);
  const Int3 &n = domain.cells();
  if (double(phase->rows.cells()) > large_share * n[0] * n[1] * n[2])
    for (Field *block : {&phase->fraction, &phase->tensor.field, &next_fraction, &next_tensor})
      if (block != &phase->tensor.field || (phase->material.carries_tensor() && !phase->boxed)) block->allocate_fully();
  PetscFunctionReturn(0);
}

}  // namespace eulastic
