#include "solver/solver.hpp"

#include "adhesion/adhesion.hpp"
#include "boxes/boxed_bodies.hpp"
#include "drops/surface_tension.hpp"
#include "field/open_boundaries.hpp"
#include "flow/projection.hpp"
#include "membranes/membrane_transport.hpp"
#include "membranes/stretch_force.hpp"
#include "openings/bodies_at_sides.hpp"
#include "openings/inlet_generators.hpp"
#include "openings/loaded_outlets.hpp"
#include "parts/state.hpp"
#include "rigid/rigid_flow.hpp"
#include "solids/grid_bodies.hpp"
#include "solids/species_force.hpp"
#include "solver/classic_step.hpp"
#include "solver/fast_step.hpp"
#include "solver/synchronised_state.hpp"

#include <algorithm>

namespace eulastic {

Solver::Solver() = default;
Solver::Solver(Solver &&) noexcept = default;
Solver &Solver::operator=(Solver &&) noexcept = default;
Solver::~Solver() = default;

int Solver::work_fields(const Method &method, int dimension, const Contents &scene) {
  const int tension = scene.surface_tension ? SurfaceTension::fields : 0;
  return std::max({Projection::work_fields(method, scene.open, scene.rigid),
                   Scheme::work_fields(method, dimension, tension), scene.membranes ? MembraneTransport::fields : 0,
                   scene.bodies ? GridBodies::work_fields(method, dimension) : 0});
}

double Solver::fields(const SolverSpec &spec, int dimension, const Contents &scene, const ViscosityContrast &contrast) {
  double sum = 2 * dimension + 1 + work_fields(spec, dimension, scene) +  // velocity, predictor, pressure
               Projection::fields(spec, dimension, scene.rigid) +
               Scheme::fields(spec, dimension, contrast, scene.bodies, scene.rigid, scene.travel) +
               scene.loaded_outlets;                             // their responses
  if (spec.staggered() && spec.fluid.inertia) sum += dimension;  // advection of the step before
  if (scene.bodies) sum += GridBodies::fields(spec, dimension, scene.elastic);
  if (scene.membranes) sum += dimension;  // their force
  if (scene.travel) sum += dimension;     // which faces are inside rigid bodies; twice that beside bodies of a file
  return sum;
}

PetscErrorCode Solver::create(const Domain &domain, const SolverSpec &spec) {
  const int dim = domain.dimension();
  PetscFunctionBeginUser;
  flow_ = std::make_unique<Flow>(domain, spec);
  boxed_ = std::make_unique<BoxedBodies>(flow_.get());
  projection_ = std::make_unique<Projection>(flow_.get());
  synchronised_ = std::make_unique<SynchronisedState>(flow_.get(), boxed_.get());
  if (spec.staggered())
    scheme_ = std::make_unique<FastStep>(flow_.get(), projection_.get());
  else
    scheme_ = std::make_unique<ClassicStep>(flow_.get(), projection_.get());
  PetscCall(projection_->create(spec.acm_memory));
  flow_->now.velocity = Field(domain, dim);
  flow_->now.pressure = Field(domain, 1);
  flow_->velocity_star = Field(domain, dim);
  if (spec.staggered() && spec.fluid.inertia) flow_->now.advection = Field(domain, dim);
  PetscCall(flow_->work.reserve(work_fields(spec, dim, {domain.any_open()})));
  PetscFunctionReturn(0);
}

// The memory of earlier increments is useless to ACM when it only preconditions the solver with rigid bodies.
PetscErrorCode Solver::set_rigid(std::unique_ptr<RigidBodies> bodies) {
  PetscFunctionBeginUser;
  if (!bodies->exist()) PetscFunctionReturn(0);
  const SolverSpec &spec = flow_->spec;
  if (spec.pressure == PressureKind::acm && !spec.is_single_acm_step()) PetscCall(projection_->create(0));
  rigid_ = std::make_unique<RigidFlow>(flow_.get(), std::move(bodies));
  PetscCall(rigid_->create(projection_->owned_solver()));
  PetscFunctionReturn(0);
}

void Solver::set_adhesion(const AdhesionSpec &spec) {
  adhesion_ = spec.pairs.empty() ? nullptr : std::make_unique<AdhesionSpec>(spec);
}

// Creates the parts of the flow in the order of a step. A new capability is a folder with its part and a line here.
PetscErrorCode Solver::make_parts() {
  Flow *flow = flow_.get();
  const std::vector<Phase> &phases = flow->now.phases;
  const BoundaryConditions &sides = flow->spec.sides;
  const auto add = [&](std::unique_ptr<FlowPart> part) {
    flow->parts.push_back(part.get());
    owned_parts_.push_back(std::move(part));
  };
  PetscFunctionBeginUser;
  std::unique_ptr<InletGenerators> generators;
  if (has_inlet_generators(sides)) generators = std::make_unique<InletGenerators>(flow, boxed_.get());
  if (generators) PetscCall(generators->create());
  if (!phases.empty()) add(std::make_unique<GridBodies>(flow));
  if (boxed_->exist()) flow->parts.push_back(boxed_.get());
  if (rigid_) flow->parts.push_back(rigid_.get());
  if (!phases.empty() && fluid_crosses(sides))
    add(std::make_unique<BodiesAtSides>(flow, boxed_.get(), generators.get()));
  if (SurfaceTension::exists(phases)) add(std::make_unique<SurfaceTension>(flow));
  if (MembraneTransport::exists(phases)) add(std::make_unique<MembraneTransport>(flow));
  if (SpeciesForces::exist(phases)) add(std::make_unique<SpeciesForces>(flow));
  if (StretchForces::exist(phases)) add(std::make_unique<StretchForces>(flow));
  if (adhesion_) add(std::make_unique<Adhesion>(flow, boxed_.get(), *adhesion_));
  if (LoadedOutlets::exist(sides)) add(std::make_unique<LoadedOutlets>(flow, projection_.get()));
  if (generators) add(std::move(generators));
  PetscFunctionReturn(0);
}

PetscErrorCode Solver::prepare() {
  State &now = flow_->now;
  const Domain &domain = flow_->domain;
  PetscFunctionBeginUser;
  PetscCall(make_parts());
  const bool tension = part<SurfaceTension>(), membranes = part<MembraneTransport>();
  PetscCall(flow_->work.reserve(work_fields(
      flow_->spec, domain.dimension(), {domain.any_open(), !now.phases.empty(), tension, membranes, bool(rigid_)})));
  for (FlowPart *part : flow_->parts) PetscCall(part->prescribe_velocity(now.time, now.velocity));
  PetscCall(flow_->update_velocity_ghosts(now.velocity, now.time, Box::stencil_width));
  PetscCall(flow_->update_centre_ghosts(now.pressure, 1));
  if (fluid_crosses(flow_->spec.sides)) PetscCall(start_flow(flow_.get(), projection_.get()));
  PetscCall(scheme_->start());
  for (FlowPart *part : flow_->parts) PetscCall(part->start());
  PetscFunctionReturn(0);
}

PetscErrorCode Solver::resume(long stages, long sweeps) {
  State &now = flow_->now;
  PetscFunctionBeginUser;
  scheme_->set_stages(stages);
  sweeps_before_ = sweeps - projection_->solver().sweeps();
  projection_->solver().forget_sound_speed();  // start_flow() has made a field solenoidal
  PetscCall(flow_->exchange.update_ghosts(now.velocity, Box::stencil_width));
  for (FlowPart *part : flow_->parts) PetscCall(part->begin_resume());
  fill_wall_ghosts_velocity(flow_->domain, flow_->spec.sides, now.time, now.velocity, Box::stencil_width);
  PetscCall(flow_->update_centre_ghosts(now.pressure, 1));
  if (now.pressure_before) PetscCall(flow_->update_centre_ghosts(now.pressure_before, 1));
  for (FlowPart *part : flow_->parts) PetscCall(part->resume());
  PetscFunctionReturn(0);
}

PetscErrorCode Solver::measure(FlowExtremes *extremes) {
  State &now = flow_->now;
  const Domain &domain = flow_->domain;
  PetscFunctionBeginUser;
  PetscCall(measure_extremes(domain, now.velocity, now.phases, extremes, boxed_->bodies().list()));
  for (int d = 0; rigid() && d < 3; ++d) extremes->speed[d] = std::max(extremes->speed[d], rigid()->speed[d]);
  now.speed_scale = std::max(extremes->max_speed(), wall_speed(flow_->spec.sides));
  for (const double speed : inflow_speed(flow_->spec.sides)) now.speed_scale = std::max(now.speed_scale, speed);
  now.crossing_rate = 0;
  for (int d = 0; d < domain.dimension(); ++d)
    now.crossing_rate = std::max(now.crossing_rate, extremes->speed[d] / domain.spacing()[d]);
  PetscFunctionReturn(0);
}

PetscErrorCode Solver::reset_unresolved(const FlowExtremes &extremes) {
  PetscFunctionBeginUser;
  for (FlowPart *part : flow_->parts) PetscCall(part->reset_unresolved(extremes.trace));
  PetscFunctionReturn(0);
}

PetscErrorCode Solver::step(double dt, const Observer &in_middle, const Observer &with_pressure) {
  const auto record_middle = [&]() -> PetscErrorCode { return in_middle ? synchronised_->at_half_step(in_middle) : 0; };
  const auto record_pressure = [&] {
    Flow &flow = *flow_;
    PetscFunctionBeginUser;
    boxed_->discard_copies();
    if (!with_pressure) PetscFunctionReturn(0);
    flow.now.velocity.swap(flow.velocity_star);
    PetscCall(with_pressure());
    flow.now.velocity.swap(flow.velocity_star);
    PetscFunctionReturn(0);
  };
  return scheme_->step(dt, record_middle, record_pressure);
}

PetscErrorCode Solver::viscosity_now(const Field **viscosity) {
  const std::vector<Phase> *phases = nullptr;
  PetscFunctionBeginUser;
  PetscCall(synchronised_->phases(&phases));
  PetscCall(scheme_->find_viscosity_of(*phases, viscosity));
  PetscFunctionReturn(0);
}

PetscErrorCode Solver::force_power(double *power) {
  const std::vector<Phase> *phases = nullptr;
  std::vector<BodyInBox> boxed;
  PetscFunctionBeginUser;
  *power = 0;
  PetscCall(synchronised_->phases(&phases));
  PetscCall(synchronised_->bodies(&boxed));
  for (FlowPart *part : flow_->parts) PetscCall(part->add_power({*phases, boxed}, power));
  PetscFunctionReturn(0);
}

PetscErrorCode Solver::surface_energy(SurfaceEnergy *measured, std::vector<SurfaceMeasure> *bodies) {
  const Domain &domain = flow_->domain;
  const std::vector<Phase> *phases = nullptr;
  std::vector<BodyInBox> boxed;
  std::vector<SurfaceSample> samples;
  PetscFunctionBeginUser;
  *measured = {};
  if (bodies) bodies->clear();
  PetscCall(synchronised_->phases(&phases));
  PetscCall(synchronised_->bodies(&boxed));
  for (FlowPart *part : flow_->parts)
    PetscCall(part->add_surface_energy({*phases, boxed}, measured, bodies ? &samples : nullptr));
  const bool membranes =
      std::any_of(phases->begin(), phases->end(), [](const Phase &phase) { return phase.material.is_membrane(); });
  if (!membranes || !bodies || flow_->bodies.bodies() == 0) PetscFunctionReturn(0);
  BodyOwners owners;
  std::vector<Int3> references;
  std::vector<int> labels;
  for (const SurfaceSample &sample : samples) labels.push_back(sample.label);
  PetscCall(flow_->bodies.connect(domain, *phases, labels, &owners, &references));
  PetscCall(measure_surfaces(domain, *phases, samples, owners, references, bodies));
  PetscCall(boxed_->give_surface_measures(boxed, owners.owned().begin, bodies));
  PetscFunctionReturn(0);
}

TimeStepLimits Solver::limits(const FlowExtremes &extremes) const { return scheme_->limits(extremes); }

long Solver::stages() const { return scheme_->stages(); }

long Solver::sweeps() const { return sweeps_before_ + projection_->solver().sweeps(); }

double Solver::sound_speed() const { return projection_->solver().sound_speed(); }

void Solver::clear_pressure_memory() { projection_->solver().clear_memory(); }

PetscErrorCode Solver::rigid_loads(std::vector<RigidLoad> *loads) {
  PetscFunctionBeginUser;
  loads->clear();
  if (rigid_) PetscCall(rigid_->loads(loads));
  PetscFunctionReturn(0);
}

// The memory of the pressure solver is optional in a file, because the solver may be changed at a restart.
PetscErrorCode Solver::carry(CarriedState *state) {
  PetscFunctionBeginUser;
  PetscCall(flow_->carry(state));
  if (Field *memory = projection_->solver().memory())
    for (int f = 0; f < memory->count(); ++f)
      state->fields.push_back(
          {"pressure_increment_" + std::to_string(f), at_centre, (*memory)[f], Stored::float64, true});
  PetscFunctionReturn(0);
}

std::size_t Solver::bytes() const {
  return flow_->bytes() + projection_->solver().bytes() + scheme_->bytes() + synchronised_->bytes();
}

}  // namespace eulastic
