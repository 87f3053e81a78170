// Outputs: rows of series.csv and bodies.h5.
#include "adhesion/adhesion.hpp"
#include "base/events.hpp"
#include "boxes/boxed_bodies.hpp"
#include "diagnostics/energy_budget.hpp"
#include "output/guards.hpp"
#include "output/outputs.hpp"
#include "output/time_step_control.hpp"
#include "rigid/rigid_flow.hpp"
#include "solver/synchronised_state.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace eulastic {
namespace {

// Strain energies are squares of what grows in proportion to time.
double energy_between(double energy, double other, double share) {
  if (energy < 0 || other < 0) return energy + share * (other - energy);
  const double root = std::sqrt(energy), between = root + share * (std::sqrt(other) - root);
  return between * between;
}

struct Between {
  double share;

  void operator()(double &value, double other) const { value += share * (other - value); }
  void operator()(Real3 &value, const Real3 &other) const {
    for (int d = 0; d < 3; ++d) (*this)(value[d], other[d]);
  }
  template <class T>
  void operator()(std::vector<T> &values, const std::vector<T> &others) const {
    for (std::size_t n = 0; n < values.size(); ++n) (*this)(values[n], others[n]);
  }

  template <class T, class... Members>
  void all(T &value, const T &other, Members... members) const {
    ((*this)(value.*members, other.*members), ...);
  }

  void operator()(FlowMeasures &flow, const FlowMeasures &other) const {
    all(flow, other, &FlowMeasures::viscous_dissipation, &FlowMeasures::phase_volume);
  }
  void operator()(BodyMeasure &body, const BodyMeasure &other) const {
    using B = BodyMeasure;
    all(body, other, &B::volume, &B::centroid, &B::velocity, &B::semi_axes, &B::taylor_deformation, &B::elastic_energy,
        &B::rest_deformation, &B::trace_max);
    // Of an axis, known but for half turns.
    body.inclination += share * std::remainder(other.inclination - body.inclination, 180);
    if (body.inclination > 90) body.inclination -= 180;
    if (body.inclination <= -90) body.inclination += 180;
  }
  void operator()(SurfaceMeasure &surface, const SurfaceMeasure &other) const {
    using S = SurfaceMeasure;
    all(surface, other, &S::area, &S::shear_energy, &S::area_energy, &S::bending_energy, &S::turning_rate,
        &S::area_strain, &S::largest_stretch);
  }
  void operator()(EnergyRates &rates, const EnergyRates &other) const {
    using E = EnergyRates;
    all(rates, other, &E::force_power, &E::wall_power, &E::elastic_power, &E::extended_power);
    rates.extended_energy = energy_between(rates.extended_energy, other.extended_energy, share);
  }
};

// The energies that the budget needs from the other measures.
void take_energies(Measured *measured) {
  EnergyState &energy = measured->energy;
  energy.kinetic = measured->flow.kinetic_energy;
  energy.elastic = measured->flow.elastic_energy;
  energy.surface = measured->surface.energy;
  energy.surface_power = measured->surface.power;
  energy.dissipation = measured->flow.viscous_dissipation;
}

// Moves `measured` by the fraction `share` towards `other`, of a later time with the same bodies and velocity:
// linearly, for strain energies their square roots. Volume drifts and loads are not changed.
void interpolate_between(const Measured &other, double share, Measured *measured) {
  const Between between{share};
  const double energy = measured->flow.elastic_energy, linear = energy + share * (other.flow.elastic_energy - energy);
  measured->flow.elastic_energy = energy_between(energy, other.flow.elastic_energy, share);
  between(measured->flow, other.flow);
  between(measured->surface.energy, other.surface.energy);
  between(measured->surface.power, other.surface.power);
  between(measured->bodies, other.bodies);
  between(measured->surfaces, other.surfaces);
  if (linear > 0)  // together they have that of the flow
    for (BodyMeasure &body : measured->bodies) body.elastic_energy *= measured->flow.elastic_energy / linear;
  between(measured->energy.rates, other.energy.rates);
  take_energies(measured);
}

}  // namespace

// All but volume drifts and strains, of phases as SynchronisedState::phases() has them; `measured`: of another time, or
// of this velocity.
PetscErrorCode Outputs::measure_all(Measured *measured) {
  PetscFunctionBeginUser;
  const State &state = solver_->state();
  Measured &m = *measured;
  const std::vector<Phase> *phases = nullptr;
  std::vector<BodyInBox> boxed;
  PetscCall(solver_->synchronised().phases(&phases));
  PetscCall(solver_->synchronised().bodies(&boxed));
  const Fluid &fluid = config_.fluid;
  const Real3 &f = fluid.body_force.force;
  const Field *viscosity = nullptr;
  PetscCall(solver_->viscosity_now(&viscosity));
  const bool again = m.time == state.time;  // with the same velocity and pressure
  if (!again || viscosity) {
    PetscCall(measure_flow(
        *domain_, state.velocity,
        {fluid.density, fluid.viscosity, state.dt, std::hypot(f[0], f[1], f[2]), viscosity, &config_.sides}, &m.flow));
    if (const auto *bodies = solver_->part<RigidFlow>())
      PetscCall(bodies->add_dissipation(&m.flow.viscous_dissipation));
  }
  PetscCall(measure_phases(*domain_, *phases, &m.flow, boxed));
  if (solver_->bodies().bodies() > 0)
    PetscCall(solver_->bodies().measure(*domain_, *phases, state.velocity, strain_energy, &m.bodies, boxed));
  PetscCall(solver_->surface_energy(&m.surface, &m.surfaces));
  // Loads follow from the pressure, which is half a step behind, as are the bodies that are measured first.
  if (!again) PetscCall(solver_->rigid_loads(&m.loads));
  if (!again) PetscCall(measure_vessel_loads(config_, solver_, &m.surface_loads));
  if (Adhesion *adhesion = solver_->part<Adhesion>(); adhesion && !again) {
    PetscCall(adhesion->measure(&m.bonds));
    if (solver_->bodies().bodies() > 0) PetscCall(adhesion->measure(solver_->bodies().bodies(), &m.body_bonds));
  }
  // beta follows from div v; where that is noise (a wave's passes through 0 twice a period), so is beta.
  constexpr double noise = 1e-5;  // of U/h
  const double sound_speed = m.flow.divergence_rms > noise ? solver_->sound_speed() : 0;
  m.mach = sound_speed > 0 ? m.flow.speed_max / sound_speed : 0;
  m.time = state.time;
  m.dt = state.dt;
  m.step = double(state.step);
  m.body_count = solver_->bodies().bodies();
  PetscCall(measure_energy(measured));
  PetscFunctionReturn(0);
}

PetscErrorCode Outputs::measure_energy(Measured *measured) {
  PetscFunctionBeginUser;
  const State &state = solver_->state();
  const Fluid &fluid = config_.fluid;
  EnergyState &energy = measured->energy = {};
  const std::vector<Phase> *phases = nullptr;
  std::vector<BodyInBox> boxed;
  PetscCall(solver_->synchronised().phases(&phases));
  PetscCall(solver_->synchronised().bodies(&boxed));
  take_energies(measured);
  const Field *viscosity = nullptr;
  PetscCall(solver_->viscosity_now(&viscosity));
  const EnergyParameters numbers{fluid.density,  fluid.viscosity, fluid.body_force.at(state.time),
                                 &config_.sides, state.time,      viscosity};
  PetscCall(measure_energy_rates(*domain_, state.velocity, *phases, numbers, &energy.rates, boxed));
  double power = 0;
  PetscCall(solver_->force_power(&power));
  energy.rates.force_power += power;
  for (std::size_t b = 0; b < measured->loads.size(); ++b) {
    const RigidLoad &load = measured->loads[b];
    energy.rates.wall_power += load.power;
    energy.wall_range += fluid.viscosity * solver_->rigid()->masses[b].dissipation(solver_->rigid()->motion_of(int(b)),
                                                                                   domain_->dimension());
  }
  PetscCall(measure_side_flows(*domain_, solver_->sides_now(), state.time, fluid.inertial_density(), state.velocity,
                               state.pressure, &measured->sides));
  for (const SideFlow &side : measured->sides) energy.rates.side_power += side.power;
  set_energy_scales(&energy);
  const bool may_start = config_.time.step == 0 || (solver_->rigid() && solver_->rigid()->moves);
  energy.starts = config_.method.staggered() && may_start && state.step <= starting_steps;
  PetscFunctionReturn(0);
}

// Elastic energy is made of differences of numbers of order 1. Where forces are balanced by a pressure, what is not is
// a part of what they give a fluid at rest in a step. Their power is at most |f| sqrt(2 rho K V), by Cauchy and
// Schwarz.
void Outputs::set_energy_scales(EnergyState *energy) const {
  double modulus = 0, volume = 1, shortest = HUGE_VAL;
  for (int d = 0; d < domain_->dimension(); ++d) {
    volume *= domain_->domain_shape().length[d];
    shortest = std::min(shortest, domain_->spacing()[d]);
  }
  const State &state = solver_->state();
  const auto size = [](const Real3 &f) { return std::hypot(f[0], f[1], f[2]); };
  double force = size(config_.fluid.body_force.force);
  for (const SpeciesSpec &spec : config_.species) force += size(spec.body_force.force);
  for (const Phase &phase : state.phases) {
    const Material &material = phase.material;
    const double surface = std::max(material.surface_tension, material.membrane.largest_modulus());
    modulus = std::max({modulus, material.shear_modulus, surface / shortest});
  }
  const double mass = config_.fluid.density * volume, speed = force * state.dt;
  energy->unknown = 1e-12 * modulus * volume + 0.5 * mass * speed * speed;
  energy->force_range = force * std::sqrt(2 * mass * energy->kinetic);
}

PetscErrorCode Outputs::await_row(double time_before) {
  PetscFunctionBeginUser;
  row_ = {};
  PetscCall(solver_->synchronised().at_half_step([this] { return measure_all(&row_); }));
  waits_ = true;
  series_time_before_ = time_before;
  PetscFunctionReturn(0);
}

PetscErrorCode Outputs::resume_row() {
  PetscFunctionBeginUser;
  const double time = solver_->state().time;
  if (!series_due_.at(time) || !solver_->phases_lag()) PetscFunctionReturn(0);
  PetscCall(await_row(std::exchange(series_due_.last_time, time)));
  PetscFunctionReturn(0);
}

void Outputs::prepare_step(double dt) {
  solver_->boxed().bodies().keep_surfaces(waits_ || series_due_.at(solver_->state().time + dt));
}

PetscErrorCode Outputs::record_middle(double dt) {
  PetscFunctionBeginUser;
  StageScope stage(Stage::output);
  EventScope scope(Event::write);
  Measured next = row_;
  PetscCall(measure_all(&next));
  const double share = row_.dt / (row_.dt + dt);
  interpolate_between(next, share, &row_);
  PetscCall(measure_largest(&row_));
  position_.mach_max = std::max(position_.mach_max, row_.mach);
  waits_ = false;
  seen_ = true;
  PetscFunctionReturn(0);
}

// The pressure is half a step behind the velocity, as phases are.
PetscErrorCode Outputs::record_pressure(double dt) {
  PetscFunctionBeginUser;
  if (row_.sides.empty()) PetscFunctionReturn(0);
  StageScope stage(Stage::output);
  const State &state = solver_->state();
  const double share = row_.dt / (row_.dt + dt);
  std::vector<SideFlow> next;
  PetscCall(measure_side_flows(*domain_, solver_->sides_now(), state.time, config_.fluid.inertial_density(),
                               state.velocity, state.pressure, &next));
  row_.energy.rates.side_power = 0;
  for (std::size_t s = 0; s < next.size(); ++s) {
    SideFlow &side = row_.sides[s];
    side.pressure += share * (next[s].pressure - side.pressure);
    side.power += share * (next[s].power - side.power);
    row_.energy.rates.side_power += side.power;
  }
  PetscFunctionReturn(0);
}

PetscErrorCode Outputs::write_waiting() {
  PetscFunctionBeginUser;
  if (!waits_ && !seen_) PetscFunctionReturn(0);
  StageScope stage(Stage::output);
  EventScope scope(Event::write);
  if (seen_)
    PetscCall(write_row());
  else
    PetscCall(write_row_now());
  PetscFunctionReturn(0);
}

PetscErrorCode Outputs::write_row_now() {
  PetscFunctionBeginUser;
  PetscCall(measure());
  row_ = now_;
  PetscCall(write_row());
  PetscFunctionReturn(0);
}

// Loads of rigid bodies are those of the middle of a step: their power at a row is between those of both steps.
PetscErrorCode Outputs::record_power() {
  PetscFunctionBeginUser;
  if (!solver_->rigid() || !solver_->rigid()->moves) PetscFunctionReturn(0);
  const double share = row_.dt / (row_.dt + solver_->state().dt);
  std::vector<RigidLoad> next;
  PetscCall(solver_->rigid_loads(&next));
  for (std::size_t b = 0; b < next.size(); ++b)
    row_.energy.rates.wall_power += share * (next[b].power - row_.loads[b].power);
  PetscFunctionReturn(0);
}

std::vector<std::pair<std::string, double>> Outputs::series_row(const Measured &row) const {
  const FlowMeasures &flow = row.flow;
  const EnergyRates &rates = row.energy.rates;
  double solid = 0;
  for (const double volume : flow.phase_volume) solid += volume;
  std::vector<std::pair<std::string, double>> columns{{"time", row.time},
                                                      {"step", row.step},
                                                      {"dt", row.dt},
                                                      {"kinetic_energy", flow.kinetic_energy},
                                                      {"elastic_energy", flow.elastic_energy},
                                                      {"viscous_dissipation", flow.viscous_dissipation},
                                                      {"bulk_velocity_x", flow.bulk_velocity[0]},
                                                      {"bulk_velocity_y", flow.bulk_velocity[1]},
                                                      {"bulk_velocity_z", flow.bulk_velocity[2]},
                                                      {"speed_max", flow.speed_max},
                                                      {"divergence_rms", flow.divergence_rms},
                                                      {"divergence_max", flow.divergence_max},
                                                      {"solid_volume", solid},
                                                      {"volume_drift", row.volume_drift},
                                                      {"force_power", rates.force_power},
                                                      {"wall_power", rates.wall_power},
                                                      {"elastic_power", rates.elastic_power},
                                                      {"energy_lost", position_.energy.lost()},
                                                      {"energy_lost_elastic", position_.energy.lost_elastic()},
                                                      {"energy_lost_extended", position_.energy.lost_extended()},
                                                      {"surface_energy", row.energy.surface},
                                                      {"surface_power", row.energy.surface_power}};
  if (!row.sides.empty()) columns.emplace_back("side_power", rates.side_power);
  for (const SideFlow &side : row.sides)
    columns.insert(columns.end(),
                   {{"flow_rate_" + side.name(), side.flow_rate}, {"pressure_" + side.name(), side.pressure}});
  for (const VesselFlow &vessel : vessel_flows(config_, row.time, flow.bulk_velocity, row.sides))
    columns.insert(columns.end(), {{vessel.species + "_flow_rate", vessel.flow_rate},
                                   {vessel.species + "_apparent_viscosity", vessel.apparent_viscosity}});
  if (!solver_->part<Adhesion>()) return columns;
  const BondTotals &bonds = row.bonds;
  columns.insert(columns.end(), {{"bonds", bonds.bonds},
                                 {"bonds_formed", bonds.formed},
                                 {"bonds_broken", bonds.broken},
                                 {"bond_force_x", bonds.force[0]},
                                 {"bond_force_y", bonds.force[1]},
                                 {"bond_force_z", bonds.force[2]}});
  return columns;
}

PetscErrorCode Outputs::write_row() {
  PetscFunctionBeginUser;
  if (seen_) PetscCall(record_power());
  waits_ = seen_ = false;
  is_new_ = true;
  position_.energy.advance(row_.time, row_.energy);
  row_.energy_made = energy_unknown_.empty() ? position_.energy.generated_share() : 0;
  std::vector<double> values;
  for (const auto &[name, value] : series_row(row_)) values.push_back(value);
  PetscCall(series_.write(values));
  if (bodies_file_) {
    const auto name = [this](int label) -> const std::string & {
      return config_.species[solver_->bodies().species(label)].name;
    };
    std::vector<double> numbers;
    for (const BodyRecord &record : records(row_, row_.bodies, row_.surfaces))
      for_numbers(record, membranes_, loads_, solver_->part<Adhesion>() != nullptr,
                  [&](const char *, const auto &value) {
                    const auto *first = reinterpret_cast<const double *>(&value);
                    numbers.insert(numbers.end(), first, first + sizeof value / sizeof(double));
                  });
    // As many as there were: others may have come since.
    PetscCall(bodies_file_->add(row_.time, {row_.body_count, name}, numbers));
    ++position_.bodies_rows;
  }
  written_ = std::move(row_);  // the next row may wait already when this one is taken
  PetscFunctionReturn(0);
}

const Measured *Outputs::new_row() {
  const bool fresh = is_new_;
  is_new_ = false;
  return fresh ? &written_ : nullptr;
}

}  // namespace eulastic
