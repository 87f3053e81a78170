#include "output/outputs.hpp"

#include "base/events.hpp"
#include "boxes/boxed_bodies.hpp"
#include "output/saved_state.hpp"
#include "output/verdict.hpp"
#include "solver/synchronised_state.hpp"

#include <algorithm>
#include <array>

namespace eulastic {

void Outputs::start(const Config &config, const Domain &domain, Solver *solver, const OutputsPosition &position) {
  config_ = config;
  domain_ = &domain;
  solver_ = solver;
  series_due_ = {config.output.series_interval, position.series_time};
  snapshot_due_ = {config.output.snapshot_interval, position.snapshot_time};
  const double now = solver->state().time;
  const bool waits = position.series_time >= 0 && series_due_.at(now);  // probes do not
  probes_time_ = waits ? now : position.series_time;
  membranes_ = std::any_of(config.species.begin(), config.species.end(),
                           [](const SpeciesSpec &spec) { return spec.is_membrane(); });
  energy_ = position.energy;
  energy_.allow_energy_return(config.method.pressure == PressureKind::acm && config.method.is_single_acm_step());
  const double apart = std::max(config.output.series_interval, config.time.step);
  energy_unknown_.clear();
  if (4 * apart > solver->limits({}).forcing)
    energy_unknown_ =
        "rows of series.csv are too far apart to resolve the oscillation; use a -series_interval of a quarter period";
  else if (has_inlet_generators(config.sides) && !config.species.empty())
    energy_unknown_ = "bodies that enter through a boundary carry energy that is not counted";
  mach_max_ = position.mach_max;
}

PetscErrorCode Outputs::open(const std::string &directory, const OutputsPosition &position, bool same_directory) {
  PetscFunctionBeginUser;
  const MPI_Comm comm = domain_->comm();
  directory_ = directory;
  Row row;
  row.sides = crossed_boundaries(config_.sides, *domain_);
  std::vector<std::string> columns;
  for (const auto &[name, value] : series_row(row)) columns.push_back(name);
  PetscCall(series_.open(comm, directory + "/series.csv", columns, same_directory ? position.series_rows : 0));
  PetscCall(samples_.open(config_.samples, *domain_, directory, probes_time_, position.profile_time));
  if (solver_->bodies().bodies() > 0) {
    const bool loads = std::any_of(config_.species.begin(), config_.species.end(),
                                   [](const SpeciesSpec &spec) { return spec.bears_load(); });
    bodies_file_ = std::make_unique<BodiesFile>(comm, directory + "/bodies.h5",
                                                BodiesColumns{membranes_, loads, solver_->part<Adhesion>() != nullptr});
    bodies_rows_ = same_directory ? position.bodies_rows : 0;
    if (same_directory) PetscCall(bodies_file_->resume(&bodies_rows_));
  }
  if (solver_->part<Adhesion>())
    PetscCall(bond_files_.open(comm, directory, same_directory ? position.bonds : BondFiles::Position{}));
  snapshots_before_ = position.snapshots;
  if (snapshot_due_.interval > 0) {
    snapshots_ = std::make_unique<SnapshotOutput>(*domain_, directory, config_.output.snapshot_vti);
    PetscCall(snapshots_->resume(static_cast<int>(position.snapshots), same_directory));
  }
  PetscFunctionReturn(0);
}

void Outputs::moved_to(const std::string &directory) {
  directory_ = directory;
  series_.moved_to(directory + "/series.csv");
  samples_.moved_to(directory);
  if (bodies_file_) bodies_file_->moved_to(directory + "/bodies.h5");
  if (solver_->part<Adhesion>()) bond_files_.moved_to(directory);
  if (snapshots_) snapshots_->moved_to(directory);
}

PetscErrorCode Outputs::measure() {
  PetscFunctionBeginUser;
  Measured &m = now_.measured;
  if (m.time == solver_->state().time) PetscFunctionReturn(0);
  PetscCall(look(&now_));
  if (solver_->bodies().first_volumes().empty()) {
    std::vector<double> volumes;
    for (const BodyMeasure &body : m.bodies) volumes.push_back(body.volume);
    solver_->bodies().set_first_volumes(std::move(volumes));
  }
  PetscCall(measure_drift(&m));
  PetscCall(measure_strains(&m));
  if (solver_->state().step > 0)
    mach_max_ = std::max(mach_max_, m.mach);  // where the flow starts div v may be anything
  m.energy_made = energy_unknown_.empty() ? budget_now().generated_share() : 0;
  PetscFunctionReturn(0);
}

// Only rows of series.csv advance the budget of the run.
EnergyBudget Outputs::budget_now() const {
  EnergyBudget budget = energy_;
  budget.advance(now_.measured.time, now_.energy);
  return budget;
}

PetscErrorCode Outputs::write_passed_snapshots(const std::vector<double> &times) {
  PetscFunctionBeginUser;
  if (times.empty()) PetscFunctionReturn(0);
  StageScope stage(Stage::output);
  EventScope scope(Event::write);
  PetscCall(solver_->synchronised().replay_last_step(times, [this] { return snapshots_->write(config_, solver_); }));
  snapshot_due_.last_time = times.back();
  PetscFunctionReturn(0);
}

PetscErrorCode Outputs::write_due(bool last) {
  PetscFunctionBeginUser;
  const State &state = solver_->state();
  const auto now = [&](Due *due) {
    if (due->interval <= 0 || due->last_time == state.time || !(last || due->at(state.time))) return false;
    due->last_time = state.time;
    return true;
  };
  if (snapshots_ && config_.output.snapshot_exact && !last)
    PetscCall(write_passed_snapshots(snapshot_due_.between(state.time - state.dt, state.time)));
  if (seen_) {
    StageScope stage(Stage::output);
    EventScope scope(Event::write);
    PetscCall(write_row());
  }
  const bool waited = last && waits_;
  if (waited) series_due_.last_time = series_time_before_;  // it is written now
  const double series_time_before = series_due_.last_time;
  const bool series = now(&series_due_), snapshot = now(&snapshot_due_);
  const bool probes = series && !waited, samples = samples_.due(state.time, probes, last);
  if (!series && !snapshot && !samples) PetscFunctionReturn(0);
  StageScope stage(Stage::output);
  EventScope scope(Event::write);
  if (Adhesion *adhesion = solver_->part<Adhesion>()) {
    if (probes) PetscCall(bond_files_.write_events(adhesion));
    if (snapshot) PetscCall(bond_files_.write_bonds(state.time, *adhesion));
  }
  if (samples)
    PetscCall(solver_->synchronised().with_bodies_on_grid([&](const std::vector<Phase> &phases) {
      return samples_.write(state.time, probes, last, {state.velocity, state.pressure, phases});
    }));
  if (series && (last || !solver_->phases_lag())) {
    PetscCall(write_row_now());
  } else if (series) {
    PetscCall(await_row(series_time_before));
  }
  if (snapshot) PetscCall(snapshots_->write(config_, solver_));
  PetscFunctionReturn(0);
}

PetscErrorCode Outputs::sync(OutputsPosition *position) {
  PetscFunctionBeginUser;
  PetscCall(series_.sync());
  PetscCall(samples_.sync());
  if (bodies_file_) PetscCall(bodies_file_->flush());
  if (solver_->part<Adhesion>()) PetscCall(bond_files_.sync(&position->bonds));
  position->series_rows = series_.rows();
  position->bodies_rows = bodies_rows_;
  position->snapshots = snapshots_ ? snapshots_->count() : snapshots_before_;
  position->series_time = waits_ ? series_time_before_ : series_due_.last_time;
  position->snapshot_time = snapshot_due_.last_time;
  position->profile_time = samples_.profile_time();
  position->energy = energy_;
  position->mach_max = mach_max_;
  PetscFunctionReturn(0);
}

// What the last row has of the flow and of its energy.
void Outputs::add_measures(const EnergyBudget &budget, Summary *summary) const {
  const Measured &measured = now_.measured;
  summary->divergence_rms = measured.flow.divergence_rms;
  summary->divergence_max = measured.flow.divergence_max;
  summary->mach_max = mach_max_;
  summary->volume_drift = measured.volume_drift;
  summary->kinetic_energy = measured.flow.kinetic_energy;
  summary->elastic_energy = measured.flow.elastic_energy;
  const EnergyState &energy = now_.energy;
  summary->viscous_dissipation = energy.dissipation;
  summary->force_power = energy.rates.force_power;
  summary->wall_power = energy.rates.wall_power;
  summary->side_power = energy.rates.side_power;
  for (const SideFlow &side : now_.sides) summary->sides.push_back({side.name(), side.flow_rate, side.pressure});
  summary->elastic_power = energy.rates.elastic_power;
  summary->energy_supplied = budget.supplied();
  summary->energy_dissipated = budget.dissipated();
  summary->energy_lost = budget.lost();
  summary->energy_lost_elastic = budget.lost_elastic();
  summary->energy_lost_extended = budget.lost_extended();
  summary->energy_made_share = budget.generated_share_max();
  summary->surface_energy = energy.surface;
  summary->surface_power = energy.surface_power;
  summary->bulk_velocity = measured.flow.bulk_velocity[0];
}

PetscErrorCode Outputs::write_summary(Summary summary) {
  PetscFunctionBeginUser;
  StageScope stage(Stage::output);
  const State &state = solver_->state();
  PetscCall(measure());
  // A failed write is not repeated: after a failed fsync the system drops the data.
  if (bodies_file_ && summary.exit_reason != "output_failed") PetscCall(bodies_file_->flush());
  summary.method = config_.method.kind == MethodKind::classic ? "classic" : "fast";
  summary.pressure_solver = std::array{"acm", "smac", "ksp"}[static_cast<int>(config_.method.pressure)];
  summary.cells = static_cast<long>(domain_->domain_cell_count());
  summary.ranks = domain_->ranks();
  summary.threads = config_.threads;
  summary.steps = static_cast<long>(state.step);
  summary.time = state.time;
  summary.dt_mean = state.step > 0 ? state.time / double(state.step) : 0;
  if (state.step > 0) {
    summary.viscous_stages_per_step = double(solver_->stages()) / double(state.step);
    const double sweeps = double(solver_->sweeps()) / double(state.step);
    (config_.method.pressure == PressureKind::ksp ? summary.ksp_iterations_per_step : summary.acm_sweeps_per_step) =
        sweeps;
  }
  summary.strain_forgotten = static_cast<long>(state.forgotten);
  const EnergyBudget budget = budget_now();
  add_measures(budget, &summary);
  PetscCall(list_bodies(&summary));
  double counted[3] = {0, 0, 0};  // bytes of fields, points where B is evolved, markers of membranes
  counted[0] = double(solver_->bytes());
  for (const Phase &phase : state.phases) counted[1] += phase.tensor.evolving.points();
  for (const BodyInBox &body : solver_->boxed().list()) counted[1] += body.phase->tensor.evolving.points();
  counted[2] = double(state.markers.size());
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, counted, 3, MPI_DOUBLE, MPI_SUM, domain_->comm()));
  summary.bytes_per_cell = counted[0] / domain_->domain_cell_count();
  summary.active_fraction = counted[1] / domain_->domain_cell_count();
  PetscCall(state_hash(solver_, &summary.state_hash));
  const double evolved = (counted[1] + counted[2]) * double(state.step);
  const Evidence evidence{budget, energy_unknown_, now_.measured, double(state.forgotten), evolved};
  verdicts_ = {judge_energy(evidence), judge_volume_and_area(config_, evidence), judge_strain(evidence)};
  summary.verdicts = verdicts_;
  PetscCall(eulastic::write_summary(domain_->comm(), directory_ + "/summary.json", summary));
  PetscFunctionReturn(0);
}

}  // namespace eulastic
