// Solver: v*, (7), by plain Euler or in viscous stages, and the forces and viscosities in it.
#include "base/deliver.hpp"
#include "field/open_sides.hpp"
#include "flow/viscous_stress.hpp"
#include "membranes/stretch_force.hpp"
#include "solids/species_force.hpp"
#include "solver/solver.hpp"

#include <algorithm>

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
  WeightedTarget slope;
  if (!now_.phases.empty() && spec_.linear_force()) slope = {&slope_, 1 / (0.5 * (now_.dt + dt))};
  const int dim = domain_->dimension();
  WorkSpace::Lease rate, before;
  PetscCall(work_->take("rate of momentum", dim, &rate));
  PetscCall(work_->take("viscous stage before", dim, &before));
  PetscCall(momentum_rate(*domain_, fluid, step, now_.velocity, now_.pressure, now_.phases, now_.advection,
                          rate.fields(), slope));
  if (has_boxed()) {
    std::vector<WeightedTarget> targets{{&rate.fields(), 1}};
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
  std::vector<WeightedTarget> pulled{{&rate.fields(), 1 / fluid.density}};
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

// Forces that pull the ends of bodies apart.

// On the phases as they are, with labels and references of the last step.
PetscErrorCode Solver::add_stretch_forces(Field &&scratch, const std::vector<WeightedTarget> &targets) {
  PetscFunctionBeginUser;
  if (!StretchForces::exist(now_.phases)) PetscFunctionReturn(0);
  BodyOwners owners;
  std::vector<Int3> references;
  StretchForces forces;
  PetscCall(bodies_.connect(*domain_, now_.phases, {}, &owners, &references));
  PetscCall(forces.find(*domain_, now_.phases, owners, references));
  PetscCall(forces.add(*exchange_, now_.phases, scratch, targets));
  PetscFunctionReturn(0);
}

PetscErrorCode Solver::stretch_power(double *power) {
  PetscFunctionBeginUser;
  *power = 0;
  if (has_boxed()) {
    std::vector<BodyInBox> bodies;
    PetscCall(bodies_now(&bodies));
    PetscCall(boxed_->stretch_power(bodies, now_.phases, power));
  }
  if (!StretchForces::exist(now_.phases)) PetscFunctionReturn(0);
  const std::vector<Phase> *phases = nullptr;
  PetscCall(phases_now(&phases));
  BodyOwners owners;
  std::vector<Int3> references;
  StretchForces forces;
  PetscCall(bodies_.connect(*domain_, *phases, {}, &owners, &references));
  PetscCall(forces.find(*domain_, *phases, owners, references));
  double on_grid = 0;
  PetscCall(forces.power(*phases, now_.velocity, &on_grid));
  *power += on_grid;
  PetscFunctionReturn(0);
}

// What depends on how far the viscosities of fluid and bodies lie apart.

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
