// Solver: what depends on how far the viscosities of fluid and bodies lie apart.
#include "base/deliver.hpp"
#include "solver/solver.hpp"

#include <algorithm>

namespace eulastic {

ViscosityContrast Solver::contrast(const std::vector<double> &trace) const {
  ViscosityContrast contrast(spec_.fluid);
  for (std::size_t p = 0; p < now_.phases.size(); ++p) {
    const Material &material = now_.phases[p].material;
    contrast.add(material, trace.empty() ? 0 : largest_stiffness(material, trace[p], domain_->dimension()));
  }
  return contrast;
}

TimeStepLimits Solver::limits(const FlowExtremes &extremes) const {
  TimeStepLimits limits = time_step_limits(*domain_, driven_fluid(), contrast(extremes.trace), spec_.sides, extremes,
                                           {spec_.staggered(), spec_.viscous == ViscousScheme::rkl});
  if (rigid_) limits.forcing = std::min(limits.forcing, rigid_->faces().shortest_period());
  return limits;
}

PetscErrorCode Solver::viscosity_now(const Field **viscosity) {
  PetscFunctionBeginUser;
  *viscosity = nullptr;
  if (!viscosity_) PetscFunctionReturn(0);
  const std::vector<Phase> *phases = nullptr;
  PetscCall(phases_now(&phases));
  PetscCall(compute_viscosity(*domain_, spec_.fluid, spec_.sides, *phases, &viscosity_));
  *viscosity = &viscosity_.fields;
  PetscFunctionReturn(0);
}

bool Solver::drifts() const {
  for (int d = 0; d < domain_->dimension(); ++d)
    for (const Side &side : spec_.sides[d])
      if (domain_->is_wall(d) && side.kind != SideKind::symmetry) return false;
  return true;
}

PetscErrorCode Solver::surface_energy(SurfaceEnergy *measured, std::vector<SurfaceMeasure> *bodies) {
  PetscFunctionBeginUser;
  *measured = {};
  std::vector<BodyInBox> boxed;
  std::vector<std::vector<SurfaceSample>> of_boxed;
  bool in_boxes = false, membranes = membranes_ != nullptr;
  for (const Phase &phase : now_.phases) {
    if (!phase.boxed) continue;
    membranes = membranes || phase.material.is_membrane();
    in_boxes = in_boxes || phase.material.is_membrane() || phase.material.surface_tension > 0;
  }
  if (bodies) bodies->clear();
  if (!surface_tension_ && !membranes_ && !in_boxes) PetscFunctionReturn(0);
  if (in_boxes) {
    PetscCall(bodies_now(&boxed));
    PetscCall(boxed_->measure_surfaces(boxed, now_.phases, measured, &of_boxed));
  }
  const std::vector<Phase> *phases = nullptr;
  PetscCall(phases_now(&phases));
  if (surface_tension_) PetscCall(surface_tension_->measure(*phases, now_.velocity, measured));
  std::vector<SurfaceSample> samples;
  if (membranes_) PetscCall(membranes_->measure(*phases, now_.velocity, measured, bodies ? &samples : nullptr));
  if (!membranes || !bodies || bodies_.bodies() == 0) PetscFunctionReturn(0);
  BodyOwners owners;
  std::vector<Int3> references;
  std::vector<int> labels;
  for (const SurfaceSample &sample : samples) labels.push_back(sample.label);
  PetscCall(bodies_.connect(*domain_, *phases, labels, &owners, &references));
  PetscCall(measure_surfaces(*domain_, *phases, samples, owners, references, bodies));
  struct Found {
    int number;
    SurfaceMeasure measure;
  };
  std::vector<Found> found;
  std::vector<int> ranks;
  for (std::size_t b = 0; b < boxed.size(); ++b) {
    if (!boxed[b].phase->material.is_membrane()) continue;
    found.push_back({boxed[b].number, measure_surface_in_box(boxed[b], of_boxed[b])});
    ranks.push_back(BodyRange::owner(boxed[b].number - 1, bodies_.bodies(), domain_->ranks()));
  }
  PetscCall(deliver(domain_->comm(), ranks, &found));
  for (const Found &one : found) (*bodies)[one.number - 1 - owners.owned().begin] = one.measure;
  PetscFunctionReturn(0);
}

bool Solver::expects_pressure(const Method &method, const ViscosityContrast &contrast, bool travel) {
  return method.staggered() && method.viscous == ViscousScheme::rkl &&
         (contrast.exists() ? contrast.settles() : travel);
}

bool Solver::expects_pressure() const { return expects_pressure(spec_, contrast({}), rigid_ && rigid_->travel()); }

// What of the pressure is wrong makes a flow only where viscosity varies or beside bodies, and there it takes steps to
// settle: that of the last step would leave the velocity behind by a few (docs/method.md, section 16).
void Solver::expect_pressure(double dt) {
  const double interval = now_.dt > 0 ? 0.5 * (now_.dt + dt) : 0;
  const double ratio = now_.pressure_interval > 0 ? interval / now_.pressure_interval : 0;
  double *now = now_.pressure.data(), *before = now_.pressure_before.data();
  const std::size_t size = now_.pressure.layout().size;
#pragma omp simd
  for (std::size_t i = 0; i < size; ++i) {
    const double p = now[i];
    now[i] = p + ratio * (p - before[i]);
    before[i] = p;
  }
  // What a body that travels has left in closed cells would go on growing there.
  if (obstacles_ && rigid_->travel()) obstacles_->copy_closed(now_.pressure_before, &now_.pressure);
  now_.pressure_interval = interval;
}

// What the viscous force would make of grad(delta p), times dt: nu div, or of the deviatoric stress in 3-D 4/3 of it;
// half of it where each step begins with the last pressure. Of a body much more viscous than the fluid nothing but the
// fluid resists a dilation, so that the viscosity of the place turns p into noise there; the least one does not at any
// contrast.
Solver::Rotation Solver::rotation() const {
  if (!spec_.staggered()) return {};
  if (!viscosity_) return {(expects_pressure() ? 1 : 0.5) * spec_.fluid.kinematic_viscosity(), 0};
  const ViscosityContrast range = contrast({});
  const double whole = domain_->dimension() == 3 ? 4. / 3 : 1;
  if (expects_pressure()) return {whole * range.least / spec_.fluid.density, 0};
  if (range.within(5)) return {0, whole / 2};
  return {whole / 2 * range.least / spec_.fluid.density, 0};
}

}  // namespace eulastic
