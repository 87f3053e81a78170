#include "solver/solver.hpp"

#include "field/law.hpp"
#include "field/open_sides.hpp"
#include "flow/correction.hpp"
#include "flow/divergence.hpp"
#include "flow/viscous_stress.hpp"
#include "pressure/acm.hpp"
#include "pressure/acm_sweeps.hpp"
#include "pressure/ksp.hpp"
#include "pressure/smac.hpp"
#include "solids/transport.hpp"

#include <algorithm>
#include <cmath>

namespace eulastic {

int Solver::work_fields(const Method &method, int dimension, const Parts &parts) {
  const bool sweeps = method.pressure == PressureKind::acm && !method.acm_of_the_paper();
  const bool formula = method.pressure == PressureKind::acm && !sweeps && !parts.open;
  const int pressure = 1 + !formula + (sweeps ? AcmSweepSolver::work_fields : 0) +
                       (parts.rigid && !method.acm_of_the_paper() ? ObstacleSolver::work_fields : 0);
  const int forces = parts.surface_tension ? SurfaceTension::work_fields : 0;
  const int membranes = parts.membranes ? MembraneTransport::work_fields : 0;
  const int momentum = (method.explicit_predictor() ? 0 : 2 * dimension) + forces;
  const int tensor = parts.bodies && method.staggered() ? static_cast<int>(tensor_components(dimension).size()) : 0;
  const int interface = parts.bodies && method.interface == InterfaceScheme::plic ? InterfaceTransport::work_fields : 0;
  return std::max({pressure, momentum, membranes, tensor, interface});
}

PetscErrorCode Solver::create(const Domain &domain, const SolverSpec &spec) {
  PetscFunctionBeginUser;
  domain_ = &domain;
  spec_ = spec;
  solids_ = SolidTransport(spec.exterior == SolidExterior::extrapolate);
  const int dim = domain.dimension();
  exchange_ = std::make_unique<GhostExchange>(domain);
  boxed_ = std::make_unique<FreeBodies>(domain, spec_.fluid, spec_.sides, spec.exterior == SolidExterior::extrapolate);
  work_ = std::make_unique<WorkSpace>(domain);
  if (spec.pressure == PressureKind::smac) {
    PetscCall(SmacSolver::create(domain, *exchange_, &pressure_solver_));
  } else if (spec.pressure == PressureKind::ksp) {
    auto ksp = std::make_unique<KspSolver>();
    PetscCall(ksp->create(domain, *exchange_));
    pressure_solver_ = std::move(ksp);
  } else if (spec.acm_of_the_paper()) {
    pressure_solver_ = std::make_unique<AcmSolver>(domain);
  } else {
    auto sweeps = std::make_unique<AcmSweepSolver>();
    PetscCall(sweeps->create(domain, *exchange_, {spec.acm_sweeps_max, spec.acm_memory, spec.acm_coarse}, *work_));
    pressure_solver_ = std::move(sweeps);
  }
  now_.velocity = Field(domain, dim);
  now_.pressure = Field(domain, 1);
  velocity_star_ = Field(domain, dim);
  PetscCall(work_->reserve(work_fields(spec, dim, {domain.any_open()})));
  if (!OutletLoads::none(spec.sides)) loads_ = std::make_unique<OutletLoads>(spec.sides);
  if (has_feeders(spec.sides)) {
    feeders_ = std::make_unique<Feeders>();
    PetscCall(feeders_->create(domain, spec.sides));
  }
  if (spec.staggered() && spec.fluid.inertia) now_.advection = Field(domain, dim);
  PetscFunctionReturn(0);
}

PetscErrorCode Solver::prepare() {
  PetscFunctionBeginUser;
  if (rigid_) impose_rigid_motion(*domain_, rigid_->faces(), now_.time, now_.velocity);
  PetscCall(exchange_->update_ghosts(now_.velocity, Box::stencil_width));
  fill_wall_ghosts_velocity(*domain_, spec_.sides, now_.time, now_.velocity, Box::stencil_width);
  PetscCall(update_centre_ghosts(now_.pressure, 1));
  if (volume_crosses(spec_.sides)) PetscCall(start_flow());
  if (loads_) PetscCall(find_responses());
  if (rigid_ && !rigid_->touching().empty()) crowded_ = rigid_->touching();
  PetscCall(start_rigid_loads());
  if (now_.phases.empty()) PetscFunctionReturn(0);
  if (spec_.linear_force()) {
    const int dim = domain_->dimension();
    velocity_star_ = {};
    Field flow(*domain_, 3 * dim);
    std::copy_n(now_.velocity.data(), domain_->layout().size * dim, flow.data());
    now_.velocity = flow.part(0, dim);
    slope_ = flow.part(dim, dim);
    velocity_star_ = flow.part(2 * dim, dim);
    flow_ = std::move(flow);
  }
  if (SurfaceTension::exists(now_.phases))
    surface_tension_ = std::make_unique<SurfaceTension>(*domain_, *exchange_, *work_, drifts());
  if (MembraneTransport::exists(now_.phases))
    membranes_ = std::make_unique<MembraneTransport>(*domain_, *exchange_, *work_, spec_.sides, drifts());
  PetscCall(work_->reserve(
      work_fields(spec_, domain_->dimension(),
                  {domain_->any_open(), true, surface_tension_ != nullptr, membranes_ != nullptr, rigid_ != nullptr})));
  if (contrast({}).exists()) viscosity_ = LocalViscosity(*domain_);
  if (expects_pressure()) now_.pressure_before = Field(*domain_, 1);
  if (!spec_.staggered() &&
      std::any_of(now_.phases.begin(), now_.phases.end(), [](const Phase &p) { return p.material.elastic(); }))
    next_tensor_ = tensor_at_rest(*domain_);
  if (spec_.interface != InterfaceScheme::plic) next_fraction_ = Field::at_rest(*domain_, 1);
  for (Phase &phase : now_.phases) {
    phase.tensor.rule = evolve_rule(phase.material);
    PetscCall(settle(phase));
    if (phase.material.is_membrane() && !phase.boxed) PetscCall(membranes_->start(&phase));
  }
  std::vector<const Phase *> rigid;
  for (const Phase &phase : now_.phases)
    if (phase.material.is_rigid() && !(rigid_ && rigid_->travels(phase))) rigid.push_back(&phase);
  if (membranes_) PetscCall(membranes_->find_walls(rigid));
  PetscCall(start_boxed_surfaces(rigid));
  PetscCall(place_markers());
  PetscCall(share_bodies());
  PetscCall(show_fractions(boxed_->list(), &now_.phases));
  if (volume_crosses(spec_.sides)) PetscCall(check_sides(true));
  if (feeders_) {
    PetscCall(feeders_->check_lumen(now_.phases, &crowded_));
    PetscCall(feeders_->start(now_.phases, boxed_->list()));
  }
  next_rows_ = now_.phases[0].rows;  // more than those of the blocks, which are at rest
  stale_.build(*domain_, now_.phases[0].fraction[0], now_.phases[0].rows, HUGE_VAL, 0, 0);
  PetscFunctionReturn(0);
}

PetscErrorCode Solver::place_markers() {
  PetscFunctionBeginUser;
  now_.markers.clear();
  for (std::size_t p = 0; p < now_.phases.size(); ++p)
    if (now_.phases[p].material.is_membrane() && !now_.phases[p].boxed)
      PetscCall(membranes_->place_markers(now_.phases[p], static_cast<int>(p), 0, &now_.markers));
  PetscCall(boxed_->place_markers());
  PetscFunctionReturn(0);
}

PetscErrorCode Solver::set_markers(const std::vector<SurfaceMarker> &markers) {
  PetscFunctionBeginUser;
  now_.markers = markers;
  if (MembraneTransport::marks(now_.phases)) PetscCall(SurfaceMarkers(*domain_).send_home(&now_.markers));
  PetscFunctionReturn(0);
}

PetscErrorCode Solver::resume(long stages, long sweeps) {
  PetscFunctionBeginUser;
  PetscCall(move_rigid(now_.time, now_.dt));
  stages_ = stages;
  sweeps_before_ = sweeps - pressure_solver_->sweeps();
  PetscCall(exchange_->update_ghosts(now_.velocity, Box::stencil_width));
  if (feeders_) PetscCall(feeders_->recall_velocity(now_.velocity, &spec_.sides));
  fill_wall_ghosts_velocity(*domain_, spec_.sides, now_.time, now_.velocity, Box::stencil_width);
  PetscCall(update_centre_ghosts(now_.pressure, 1));
  if (now_.pressure_before) PetscCall(update_centre_ghosts(now_.pressure_before, 1));
  PetscCall(start_rigid_loads());
  for (Phase &phase : now_.phases) {
    PetscCall(find_rows(phase));
    PetscCall(find_solid(*domain_, phase));
    if (phase.boxed) continue;
    if (phase.material.is_membrane())
      PetscCall(membranes_->extend(&phase));
    else if (phase.material.elastic())
      PetscCall(place_of_phases().update_ghosts(phase.tensor.field, Box::stencil_width, &phase.rows));
  }
  PetscCall(share_bodies());
  PetscCall(show_fractions(boxed_->list(), &now_.phases));
  PetscFunctionReturn(0);
}

EvolveRule Solver::evolve_rule(const Material &material) const {
  if (material.is_membrane()) return around_membranes;
  if (!material.elastic()) return {};
  const bool reset = spec_.exterior == SolidExterior::identity;
  const bool linear =
      material.attached && damps_short_waves(domain_->spacing(), domain_->dimension(), spec_.fluid, material);
  EvolveRule rule = reset ? reset_below_one_per_cent : linear ? evolve_where_full : evolve_above_half;
  // The stress is that of the step's start, and centres where B is I have none: not so where B.B sees their edges.
  const bool edges = with_law(material, [](const auto &law) { return law.couples_edges; });
  if (!spec_.staggered() && !edges) rule.reach = 1;
  if (!reset && spec_.interface == InterfaceScheme::weno5) rule.stressed = -1e300;  // smeared everywhere, and below 0
  // In cut cells B of a free body follows the velocity of the mixture, and is not that of the solid alone.
  const bool alone = linear || material.viscosity < spec_.fluid.viscosity;
  if (!reset && material.viscosity > 0 && alone) rule.viscosity_excess = material.viscosity / spec_.fluid.viscosity - 1;
  return rule;
}

PetscErrorCode Solver::measure(FlowExtremes *extremes) {
  PetscFunctionBeginUser;
  PetscCall(measure_extremes(*domain_, now_.velocity, now_.phases, extremes, boxed_->list()));
  for (int d = 0; rigid_ && d < 3; ++d) extremes->speed[d] = std::max(extremes->speed[d], rigid_->faces().speed[d]);
  double scale = extremes->max_speed();
  scale = std::max(scale, wall_speed(spec_.sides));
  for (const double speed : inflow_speed(spec_.sides)) scale = std::max(scale, speed);
  now_.speed_scale = scale;
  now_.crossing_rate = 0;
  for (int d = 0; d < domain_->dimension(); ++d)
    now_.crossing_rate = std::max(now_.crossing_rate, extremes->speed[d] / domain_->spacing()[d]);
  PetscFunctionReturn(0);
}

std::size_t Solver::bytes() const {
  std::size_t sum = now_.velocity.bytes() + now_.pressure.bytes() + now_.pressure_before.bytes() +
                    velocity_star_.bytes() + next_fraction_.bytes() + next_tensor_.bytes() + now_.advection.bytes() +
                    work_->bytes() + flow_.bytes() + viscosity_.bytes() + pressure_solver_->bytes() +
                    (rigid_ ? rigid_->bytes() : 0) + (rigid_impulse_ ? rigid_impulse_->bytes() : 0) +
                    (loads_ ? loads_->bytes() : 0) + (membranes_ ? membranes_->bytes() : 0) + boxed_->bytes();
  for (const std::vector<Phase> *phases : {&now_.phases, &phases_now_})
    for (const Phase &phase : *phases) {
      if (phase.boxed) continue;  // nobody writes there
      sum += phase.fraction.bytes() + phase.label.bytes();
      if (phase.material.carries_tensor()) sum += phase.tensor.field.bytes();  // else nobody writes there
    }
  return sum;
}

PetscErrorCode Solver::step(double dt, const Look &in_middle, const Look &with_pressure) {
  constexpr int shared_every = 100;  // steps: bodies move by some cells meanwhile
  PetscFunctionBeginUser;
  forget_looks();
  if (now_.step > 0 && now_.step % shared_every == 0) PetscCall(share_bodies());
  if (spec_.staggered()) PetscCall(transport_to_middle(0.5 * (now_.dt + dt)));  // (4)(5)
  if (in_middle) PetscCall(look_behind(in_middle));
  if (now_.pressure_before) expect_pressure(dt);
  if (obstacles_ && rigid_->travel()) {
    PetscCall(obstacles_->extend(now_.pressure));
    PetscCall(update_centre_ghosts(now_.pressure, 1));
  }
  PetscCall(move_rigid(now_.time + dt, dt));
  PetscCall(predict(dt));  // (7)
  if (feeders_) {
    PetscCall(exchange_->update_ghosts(velocity_star_, Box::stencil_width));
    PetscCall(feeders_->feed_velocity(now_.time + dt, velocity_star_, &spec_.sides));
  }
  PetscCall(update_velocity_ghosts(velocity_star_, now_.time + dt, 1));
  PetscCall(project(dt));  // (8)-(13)
  forget_looks();
  if (with_pressure) {
    now_.velocity.swap(velocity_star_);
    PetscCall(with_pressure());
    now_.velocity.swap(velocity_star_);
  }
  PetscCall(update_velocity_ghosts(now_.velocity, now_.time + dt, Box::stencil_width));
  if (!spec_.staggered()) PetscCall(transport(now_.phases, dt));  // (4)(5)
  PetscCall(follow_bodies(dt));
  if (!now_.phases.empty() && volume_crosses(spec_.sides)) PetscCall(check_sides(false));
  if (rigid_ && !rigid_->touching().empty()) crowded_ = rigid_->touching();
  now_.time += dt;
  now_.dt = dt;
  ++now_.step;
  PetscFunctionReturn(0);
}

// Solids move to the middle of the step. What the elastic force was before is kept, to say how it changes within the
// step.
PetscErrorCode Solver::transport_to_middle(double dt) {
  PetscFunctionBeginUser;
  if (now_.phases.empty()) PetscFunctionReturn(0);
  if (spec_.linear_force()) {
    const double scale = -1 / (dt * spec_.fluid.density);
    PetscCall(compute_elastic_force(*domain_, scale, now_.phases, slope_));
    if (surface_tension_) PetscCall(surface_tension_->add_force(now_.phases, scale, false, slope_));
    if (membranes_) PetscCall(membranes_->add_force(now_.phases, scale, false, slope_));
    WorkSpace::Lease scratch;
    PetscCall(work_->take("stretch force", 1, &scratch));
    PetscCall(add_stretch_forces(scratch.part(0, 1), {{&slope_, scale}}));
    if (has_boxed()) PetscCall(boxed_->add_forces({{&slope_, -1 / dt}}));
  }
  PetscCall(transport(now_.phases, dt));
  long unresolved = 0;
  if (has_boxed()) PetscCall(boxed_->advance({now_.time, dt, now_.step}, now_.velocity, &unresolved));
  now_.forgotten += unresolved;
  PetscCall(show_fractions(boxed_->list(), &now_.phases));
  PetscFunctionReturn(0);
}

// At rest: what the force makes in a step, and never less than a Courant number of 1e-6.
double Solver::speed_scale(double dt) const {
  const Real3 f = driven_fluid().body_force.force, &h = domain_->spacing();
  return std::max({now_.speed_scale, dt * std::hypot(f[0], f[1], f[2]), 1e-6 * std::min(h[0], h[1]) / dt});
}

PetscErrorCode Solver::project(double dt) {
  PetscFunctionBeginUser;
  const double density = spec_.fluid.density;
  const Rotation rotate = rotation();
  const Real3 &h = domain_->spacing();
  const double shortest = domain_->dimension() == 3 ? std::min({h[0], h[1], h[2]}) : std::min(h[0], h[1]);
  WorkSpace::Lease of_velocity, increment;
  PetscCall(work_->take("divergence", 1, &of_velocity));
  if (!pressure_solver_->formula()) PetscCall(work_->take("pressure increment", 1, &increment));
  Field &divergence = of_velocity.fields();
  PetscCall(compute_divergence(*domain_, density, velocity_star_, divergence));
  PetscCall(exchange_->update_ghosts(divergence, 1));
  fill_ghosts_of_increment(*domain_, divergence[0], 1);
  pressure_solver_->set_target(spec_.acm_tolerance * density * speed_scale(dt) / shortest);
  PetscCall(pressure_solver_->solve(dt, divergence, now_.pressure, increment.fields()));  // (10) or (11)
  if (obstacles_ && spec_.staggered()) PetscCall(obstacles_->spread(expects_pressure() ? 1 : 0.5, divergence));
  if (rigid_impulse_) rigid_impulse_->set_pressure(now_.pressure);
  if (rigid_impulse_ && !pressure_solver_->formula())
    rigid_impulse_->add_increment(increment.fields(), obstacles_ != nullptr);
  if (const kernels::AcmIncrement *formula = pressure_solver_->formula())
    PetscCall(
        correct_velocity(*domain_, density, dt, rotate.uniform, *formula, divergence, velocity_star_, now_.pressure));
  else
    PetscCall(correct_velocity(*domain_, density, dt, rotate.uniform, increment.fields(), divergence, velocity_star_,
                               now_.pressure));
  if (rigid_impulse_ && pressure_solver_->formula()) rigid_impulse_->set_pressure(now_.pressure);
  respect_rigid(now_.time + dt, dt, increment.fields(), velocity_star_);
  if (loads_) PetscCall(settle_loads(dt, divergence, increment.fields()));
  if (rotate.local > 0)
    PetscCall(rotate_pressure(*domain_, viscosity_.fields, rotate.local, divergence, now_.pressure));
  now_.velocity.swap(velocity_star_);
  PetscFunctionReturn(0);
}

PetscErrorCode Solver::update_velocity_ghosts(Field &velocity, double time, int width) {
  PetscFunctionBeginUser;
  PetscCall(exchange_->update_ghosts(velocity, width));
  fill_wall_ghosts_velocity(*domain_, spec_.sides, time, velocity, width);
  PetscFunctionReturn(0);
}

PetscErrorCode Solver::update_centre_ghosts(Field &field, int width) {
  PetscFunctionBeginUser;
  PetscCall(exchange_->update_ghosts(field, width));
  fill_wall_ghosts_even(*domain_, at_centre, field[0], width);
  PetscFunctionReturn(0);
}

}  // namespace eulastic
