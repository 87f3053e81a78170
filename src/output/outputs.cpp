#include "output/outputs.hpp"

#include "base/events.hpp"
#include "boxes/boxed_bodies.hpp"
#include "io/checksum.hpp"
#include "io/text_file.hpp"
#include "output/saved_state.hpp"
#include "output/snapshot_output.hpp"
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
  loads_ = std::any_of(config.species.begin(), config.species.end(),
                       [](const SpeciesSpec &spec) { return spec.bears_load(); });
  position_ = position;
  position_.energy.allow_energy_return(config.method.pressure == PressureKind::acm &&
                                       config.method.is_single_acm_step());
  const double apart = std::max(config.output.series_interval, config.time.step);
  energy_unknown_.clear();
  if (4 * apart > solver->limits({}).forcing)
    energy_unknown_ =
        "rows of series.csv are too far apart to resolve the oscillation; use a -series_interval of a quarter period";
  else if (has_inlet_generators(config.sides) && !config.species.empty())
    energy_unknown_ = "bodies that enter through a boundary carry energy that is not counted";
}

PetscErrorCode Outputs::open(const std::string &directory, bool same_directory) {
  PetscFunctionBeginUser;
  const MPI_Comm comm = domain_->comm();
  directory_ = directory;
  Measured row;
  row.sides = crossed_boundaries(config_.sides, *domain_);
  std::vector<std::string> columns;
  for (const auto &[name, value] : series_row(row)) columns.push_back(name);
  PetscCall(series_.open(comm, directory + "/series.csv", columns, same_directory ? position_.series_rows : 0));
  PetscCall(samples_.open(config_.samples, *domain_, directory, probes_time_, position_.profile_time));
  if (solver_->bodies().bodies() > 0) {
    std::vector<BodyColumn> of_bodies;
    for_numbers({}, membranes_, loads_, solver_->part<Adhesion>() != nullptr, [&](const char *name, const auto &value) {
      of_bodies.push_back({name, static_cast<int>(sizeof value / sizeof(double))});
    });
    bodies_file_ = std::make_unique<BodiesFile>(comm, directory + "/bodies.h5", of_bodies);
    if (!same_directory) position_.bodies_rows = 0;
    if (same_directory) PetscCall(bodies_file_->resume(&position_.bodies_rows));
  }
  if (solver_->part<Adhesion>())
    PetscCall(bond_files_.open(comm, directory, same_directory ? position_.bonds : BondFiles::Position{}));
  if (snapshot_due_.interval > 0) {
    snapshots_ = std::make_unique<SnapshotWriter>(*domain_, directory, config_.output.snapshot_vti);
    PetscCall(snapshots_->resume(static_cast<int>(position_.snapshots), same_directory));
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
  Measured &m = now_;
  if (m.time == solver_->state().time) PetscFunctionReturn(0);
  PetscCall(measure_all(&now_));
  if (solver_->bodies().first_volumes().empty()) {
    std::vector<double> volumes;
    for (const BodyMeasure &body : m.bodies) volumes.push_back(body.volume);
    solver_->bodies().set_first_volumes(std::move(volumes));
  }
  PetscCall(measure_largest(&m));
  if (solver_->state().step > 0)
    position_.mach_max = std::max(position_.mach_max, m.mach);  // where the flow starts div v may be anything
  m.energy_made = energy_unknown_.empty() ? budget_now().generated_share() : 0;
  PetscFunctionReturn(0);
}

// Only rows of series.csv advance the budget of the run.
EnergyBudget Outputs::budget_now() const {
  EnergyBudget budget = position_.energy;
  budget.advance(now_.time, now_.energy);
  return budget;
}

PetscErrorCode Outputs::write_passed_snapshots(const std::vector<double> &times) {
  PetscFunctionBeginUser;
  if (times.empty()) PetscFunctionReturn(0);
  StageScope stage(Stage::output);
  EventScope scope(Event::write);
  PetscCall(solver_->synchronised().replay_last_step(
      times, [this] { return write_snapshot(config_, solver_, snapshots_.get()); }));
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
  if (snapshot) PetscCall(write_snapshot(config_, solver_, snapshots_.get()));
  PetscFunctionReturn(0);
}

PetscErrorCode Outputs::sync(OutputsPosition *position) {
  PetscFunctionBeginUser;
  PetscCall(series_.sync());
  PetscCall(samples_.sync());
  if (bodies_file_) PetscCall(bodies_file_->flush());
  if (solver_->part<Adhesion>()) PetscCall(bond_files_.sync(&position_.bonds));
  position_.series_rows = series_.rows();
  if (snapshots_) position_.snapshots = snapshots_->count();
  position_.series_time = waits_ ? series_time_before_ : series_due_.last_time;
  position_.snapshot_time = snapshot_due_.last_time;
  position_.profile_time = samples_.profile_time();
  *position = position_;
  PetscFunctionReturn(0);
}

// Adds the progress of the time loop and its speed.
void Outputs::add_progress(const RunSummary &run, const Totals &totals, Json *json) const {
  const State &state = solver_->state();
  const double cells = domain_->domain_cell_count(), steps = double(state.step), updates = cells * steps;
  const double sweeps = state.step > 0 ? double(solver_->sweeps()) / steps : 0;
  const bool ksp = config_.method.pressure == PressureKind::ksp;
  json->add("version", std::string(EULASTIC_VERSION))
      .add("method", std::string(config_.method.kind == MethodKind::classic ? "classic" : "fast"))
      .add("pressure_solver", std::string(std::array{"acm", "smac", "ksp"}[static_cast<int>(config_.method.pressure)]))
      .add("exit_reason", run.exit_reason)
      .add("checkpoint", run.checkpoint)
      .add("cells", static_cast<long>(cells))
      .add("ranks", static_cast<long>(domain_->ranks()))
      .add("threads", static_cast<long>(config_.threads))
      .add("steps", static_cast<long>(state.step))
      .add("time", state.time)
      .add("dt_mean", state.step > 0 ? state.time / steps : 0)
      .add("wall_seconds", run.wall_seconds)
      .add("wall_seconds_total", run.wall_seconds_total)
      .add("cell_updates_per_second", updates / run.wall_seconds)
      .add("ns_per_cell_step", 1e9 * run.wall_seconds / updates)
      .add("bytes_per_cell", totals.bytes / cells)
      .add("active_fraction", totals.evolving / cells)
      .add("acm_sweeps_per_step", ksp ? 0 : sweeps)
      .add("ksp_iterations_per_step", ksp ? sweeps : 0)
      .add("viscous_stages_per_step", state.step > 0 ? double(solver_->stages()) / steps : 0)
      .add("strain_forgotten", static_cast<long>(state.forgotten));
}

// What the last row has of the flow and of its energy.
void Outputs::add_measures(const EnergyBudget &budget, Json *json) const {
  const FlowMeasures &flow = now_.flow;
  const EnergyState &energy = now_.energy;
  json->add("divergence_rms", flow.divergence_rms)
      .add("divergence_max", flow.divergence_max)
      .add("mach_max", position_.mach_max)
      .add("volume_drift", now_.volume_drift)
      .add("kinetic_energy", flow.kinetic_energy)
      .add("elastic_energy", flow.elastic_energy)
      .add("viscous_dissipation", energy.dissipation)
      .add("force_power", energy.rates.force_power)
      .add("wall_power", energy.rates.wall_power)
      .add("elastic_power", energy.rates.elastic_power)
      .add("energy_supplied", budget.supplied())
      .add("energy_dissipated", budget.dissipated())
      .add("energy_lost", budget.lost())
      .add("energy_lost_elastic", budget.lost_elastic())
      .add("energy_lost_extended", budget.lost_extended())
      .add("energy_made_share", budget.generated_share_max())
      .add("surface_energy", energy.surface)
      .add("surface_power", energy.surface_power)
      .add("side_power", energy.rates.side_power);
}

PetscErrorCode Outputs::write_summary(const RunSummary &run) {
  PetscFunctionBeginUser;
  StageScope stage(Stage::output);
  const State &state = solver_->state();
  PetscCall(measure());
  // A failed write is not repeated: after a failed fsync the system drops the data.
  if (bodies_file_ && run.exit_reason != "output_failed") PetscCall(bodies_file_->flush());
  Totals totals{double(solver_->bytes()), 0, double(state.markers.size())};
  for (const Phase &phase : state.phases) totals.evolving += phase.tensor.evolving.points();
  for (const BodyInBox &body : solver_->boxed().bodies().list())
    totals.evolving += body.phase->tensor.evolving.points();
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &totals, 3, MPI_DOUBLE, MPI_SUM, domain_->comm()));
  std::uint64_t hash = 0;
  std::vector<Json> files, sides, verdicts, bodies;
  PetscCall(list_bodies(&bodies));
  PetscCall(state_hash(solver_, &hash));
  const EnergyBudget budget = budget_now();
  const double evolved = (totals.evolving + totals.markers) * double(state.step);
  const Evidence evidence{budget, energy_unknown_, now_, double(state.forgotten), evolved};
  verdicts_ = {judge_energy(evidence), judge_volume_and_area(config_, evidence), judge_strain(evidence)};
  for (const InputFile &file : run.files)
    files.push_back(Json().add("option", file.option).add("path", file.path).add("content", file.content));
  for (const SideFlow &side : now_.sides)
    sides.push_back(Json().add("side", side.name()).add("flow_rate", side.flow_rate).add("pressure", side.pressure));
  for (const Verdict &verdict : verdicts_)
    verdicts.push_back(Json().add("of", verdict.of).add("verdict", verdict.verdict).add("why", verdict.why));
  Json json;
  add_progress(run, totals, &json);
  add_measures(budget, &json);
  json.add("files", files)
      .add("sides", sides)
      .add("verdicts", verdicts)
      .add("bulk_velocity", now_.flow.bulk_velocity[0])
      .add("state_hash", checksum_text(hash))
      .add("bodies", bodies);
  PetscCall(write_text_file(domain_->comm(), directory_ + "/summary.json", json.text()));
  PetscFunctionReturn(0);
}

}  // namespace eulastic
