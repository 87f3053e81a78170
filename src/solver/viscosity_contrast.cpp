// Solver: what depends on how far the viscosities of fluid and bodies lie apart.
#include "solver/solver.hpp"

#include <algorithm>

namespace eulastic {

ViscosityContrast Solver::contrast(const std::vector<double> &trace) const {
  ViscosityContrast contrast(spec_.fluid);
  for (std::size_t p = 0; p < now_.phases.size(); ++p) {
    const Material &material = now_.phases[p].material;
    contrast.add(material, trace.empty() ? 0 : largest_stiffness(material, trace[p], grid_->dimension()));
  }
  return contrast;
}

TimeStepLimits Solver::limits(const FlowExtremes &extremes) const {
  TimeStepLimits limits = time_step_limits(*grid_, driven_fluid(), contrast(extremes.trace), spec_.sides, extremes,
                                           {spec_.staggered(), spec_.viscous == ViscousScheme::rkl});
  if (rigid_) limits.forcing = std::min(limits.forcing, rigid_->faces().shortest_period());
  return limits;
}

PetscErrorCode Solver::viscosity_now(const FieldBlock **viscosity) {
  PetscFunctionBeginUser;
  *viscosity = nullptr;
  if (!viscosity_) PetscFunctionReturn(0);
  const std::vector<Phase> *phases = nullptr;
  PetscCall(phases_now(&phases));
  PetscCall(compute_viscosity(*grid_, spec_.fluid, *phases, &viscosity_));
  *viscosity = &viscosity_.fields;
  PetscFunctionReturn(0);
}

bool Solver::drifts() const {
  for (int d = 0; d < grid_->dimension(); ++d)
    for (const Side &side : spec_.sides[d])
      if (grid_->is_wall(d) && side.kind != SideKind::symmetry) return false;
  return true;
}

PetscErrorCode Solver::surface_energy(SurfaceEnergy *measured, std::vector<SurfaceMeasure> *bodies) {
  PetscFunctionBeginUser;
  *measured = {};
  if (!surface_tension_ && !membranes_) PetscFunctionReturn(0);
  const std::vector<Phase> *phases = nullptr;
  PetscCall(phases_now(&phases));
  if (surface_tension_) PetscCall(surface_tension_->measure(*phases, now_.velocity, measured));
  if (!membranes_) PetscFunctionReturn(0);
  std::vector<SurfaceSample> samples;
  PetscCall(membranes_->measure(*phases, now_.velocity, measured, bodies ? &samples : nullptr));
  if (!bodies || bodies_.bodies() == 0) PetscFunctionReturn(0);
  BodyOwners owners;
  std::vector<Int3> references;
  std::vector<int> labels;
  for (const SurfaceSample &sample : samples) labels.push_back(sample.label);
  PetscCall(bodies_.connect(*grid_, *phases, labels, &owners, &references));
  PetscCall(measure_surfaces(*grid_, *phases, samples, owners, references, bodies));
  PetscFunctionReturn(0);
}

// Half of what the viscous force would make of grad(delta p), times dt: nu div, or of the deviatoric stress in 3-D 4/3
// of it. With the viscosity of the place p turns into noise where bodies are 20 or 100 times as viscous; with the least
// one it does not at any contrast.
Solver::Rotation Solver::rotation() const {
  if (!spec_.staggered()) return {};
  if (!viscosity_) return {0.5 * spec_.fluid.kinematic_viscosity(), 0};
  constexpr double moderate = 5;
  const ViscosityContrast range = contrast({});
  const double share = grid_->dimension() == 3 ? 2. / 3 : 0.5;
  if (range.most <= moderate * range.fluid && range.fluid <= moderate * range.least) return {0, share};
  return {share * range.least / spec_.fluid.density, 0};
}

}  // namespace eulastic
