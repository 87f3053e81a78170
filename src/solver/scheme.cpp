#include "solver/scheme.hpp"

#include "bodies/labels.hpp"
#include "field/open_boundaries.hpp"
#include "flow/implicit_viscosity.hpp"
#include "flow/projection.hpp"
#include "flow/viscous_stress.hpp"
#include "rigid/rigid_surfaces.hpp"

#include <algorithm>

namespace eulastic {

int Scheme::work_fields(const Method &method, int dimension, int forces) {
  return method.staggered() ? dimension + std::max(dimension, forces) : forces;
}

double Scheme::fields(const Method &method, int dimension, const ViscosityContrast &contrast, bool bodies, bool rigid,
                      bool travel) {
  double sum = 0;
  if (contrast.exists()) sum += LocalViscosity::components(dimension);
  if (method.implicit_viscosity(contrast.exists(), rigid)) sum += ImplicitViscosity::fields(dimension);
  if (extrapolates_pressure(method, contrast, travel)) sum += 1;
  if (bodies && method.linear_force()) sum += dimension;  // slope
  return sum;
}

bool Scheme::extrapolates_pressure(const Method &method, const ViscosityContrast &contrast, bool travel) {
  return method.staggered() && !method.explicit_viscosity() &&
         (contrast.exists() ? contrast.allows_pressure_extrapolation() : travel);
}

PetscErrorCode Scheme::start() {
  PetscFunctionBeginUser;
  const ViscosityContrast range = contrast({});
  if (range.exists()) viscosity_ = LocalViscosity(flow_.domain);
  if (extrapolates_pressure(flow_.spec, range, flow_.rigid && flow_.rigid->travels))
    flow_.now.pressure_before = Field(flow_.domain, 1);
  PetscFunctionReturn(0);
}

std::size_t Scheme::bytes() const { return viscosity_.bytes(); }

ViscosityContrast Scheme::contrast(const std::vector<double> &trace) const {
  ViscosityContrast contrast(flow_.fluid);
  for (std::size_t p = 0; p < flow_.now.phases.size(); ++p) {
    const Material &material = flow_.now.phases[p].material;
    contrast.add(material, trace.empty() ? 0 : largest_stiffness(material, trace[p], flow_.domain.dimension()));
  }
  return contrast;
}

TimeStepLimits Scheme::limits(const FlowExtremes &extremes) const {
  TimeStepLimits limits =
      time_step_limits(flow_.domain, flow_.driven_fluid(), contrast(extremes.trace), flow_.spec.sides, extremes,
                       {flow_.staggered(), !flow_.spec.explicit_viscosity()});
  for (const FlowPart *part : flow_.parts) {
    limits.forcing = std::min(limits.forcing, part->shortest_period());
    limits.bonds = std::min(limits.bonds, part->largest_step());
  }
  return limits;
}

PetscErrorCode Scheme::find_viscosity_of(const std::vector<Phase> &phases, const Field **viscosity) {
  PetscFunctionBeginUser;
  *viscosity = nullptr;
  if (!viscosity_) PetscFunctionReturn(0);
  PetscCall(compute_viscosity(flow_.domain, flow_.fluid, flow_.spec.sides, phases, &viscosity_));
  *viscosity = &viscosity_.fields;
  PetscFunctionReturn(0);
}

PetscErrorCode Scheme::find_viscosity(Fluid *fluid) {
  const Field *fields = nullptr;
  PetscFunctionBeginUser;
  *fluid = flow_.fluid;
  PetscCall(find_viscosity_of(flow_.now.phases, &fields));
  if (fields) fluid->viscosity = 0;
  PetscFunctionReturn(0);
}

// Viscous forces on cut faces of rigid bodies are part of their own rate already, so these faces keep their values.
PetscErrorCode Scheme::add_local_viscous_force(double scale, Field &to) {
  std::vector<double> cut;
  PetscFunctionBeginUser;
  if (!viscosity_) PetscFunctionReturn(0);
  if (flow_.rigid) cut = cut_face_values(flow_.domain, *flow_.rigid, to);
  PetscCall(add_viscous_force(flow_.domain, viscosity_, scale, flow_.now.velocity, to));
  if (flow_.rigid) set_cut_face_values(flow_.domain, *flow_.rigid, cut, to);
  PetscFunctionReturn(0);
}

PetscErrorCode Scheme::move_bodies(double dt) {
  PetscFunctionBeginUser;
  for (FlowPart *part : flow_.parts) PetscCall(part->move(dt, &flow_.now.phases));
  PetscFunctionReturn(0);
}

PetscErrorCode Scheme::project(double dt, const RotationalUpdate &rotation, const Observer &with_pressure) {
  State &now = flow_.now;
  PetscFunctionBeginUser;
  for (FlowPart *part : flow_.parts) PetscCall(part->constrain(dt));
  PetscCall(flow_.update_velocity_ghosts(flow_.velocity_star, now.time + dt, 1));
  PetscCall(projection_.end_step(dt, rotation, viscosity_.fields));
  PetscCall(with_pressure());
  PetscCall(flow_.update_velocity_ghosts(now.velocity, now.time + dt, Box::stencil_width));
  PetscFunctionReturn(0);
}

// Labels are updated on a schedule of the run, which does not depend on measures or output.
PetscErrorCode Scheme::end_step(double dt) {
  // Cells. carry_labels() permits half a cell; the margin allows for a speed that is some steps old.
  constexpr double allowed = 0.3;
  State &now = flow_.now;
  PetscFunctionBeginUser;
  now.travel_since_labels += now.crossing_rate * dt;
  if (flow_.bodies.bodies() > 0 && now.travel_since_labels >= allowed) {
    for (FlowPart *part : flow_.parts) PetscCall(part->position_phases(now.time + dt, &now.phases));
    for (Phase &phase : now.phases)
      if (phase.label) PetscCall(carry_labels(flow_.domain, flow_.exchange, &phase));
    PetscCall(flow_.bodies.follow(flow_.domain, now.phases));
    for (FlowPart *part : flow_.parts) PetscCall(part->update_after_labels());
    now.travel_since_labels = 0;
  }
  for (FlowPart *part : flow_.parts) PetscCall(part->end_step());
  now.time += dt;
  now.dt = dt;
  ++now.step;
  PetscFunctionReturn(0);
}

}  // namespace eulastic
