// Output files of a run: series.csv, bodies.h5, snapshots, summary.json. Reads the state without changing it.
#pragma once

#include "base/petsc.hpp"
#include "diagnostics/energy_budget.hpp"
#include "diagnostics/side_flows.hpp"
#include "grid/domain.hpp"
#include "io/bodies_file.hpp"
#include "io/json.hpp"
#include "io/series.hpp"
#include "io/snapshot.hpp"
#include "membranes/surface_measures.hpp"
#include "options/parse_options.hpp"
#include "output/body_record.hpp"
#include "output/bond_files.hpp"
#include "output/due.hpp"
#include "output/guards.hpp"
#include "output/sample_files.hpp"
#include "output/verdict.hpp"
#include "scene/config.hpp"
#include "scene/vessels.hpp"
#include "solver/solver.hpp"

#include <memory>

namespace eulastic {

/// Position in the output files of a run, which a restart needs to continue them.
struct OutputsPosition {
  long series_rows = 0, bodies_rows = 0, snapshots = 0;
  double series_time = -1, snapshot_time = -1, profile_time = -1;  ///< of the last one; negative: none yet
  EnergyBudget energy;
  double mach_max = 0;
  BondFiles::Position bonds;
};

/// Values of summary.json other than those of the state and the outputs; docs/outputs.md describes every key.
struct RunSummary {
  std::string exit_reason;  ///< time_end, steps, signal, wall_limit, nonfinite, guard, output_failed or unfinished
  std::string checkpoint;   ///< file, in the same directory, from which the run can continue; empty = none
  double wall_seconds = 0;  ///< of the time loop without output
  double wall_seconds_total = 0;
  std::vector<InputFile> files;
};

class Outputs {
public:
  /// Measures are available after this call. `position`: of the run that a restart continues.
  void start(const Config &config, const Domain &domain, Solver *solver, const OutputsPosition &position);
  /// Opens the files in `directory`, which exists and is locked by this run. At a restart in the same directory its
  /// files are cut back to the position of start().
  PetscErrorCode open(const std::string &directory, bool same_directory);
  /// Rank 0 has moved the files.
  void moved_to(const std::string &directory);
  /// Syncs all rows to the disk and returns their position.
  PetscErrorCode sync(OutputsPosition *position);
  /// Writes all outputs that are due: the first state at or after each multiple of the interval, with its true time.
  /// If phases are half a step behind, a row of series.csv is completed in the next step, except for the last one.
  PetscErrorCode write_due(bool last);
  bool row_waits() const { return waits_; }
  /// Called before a step of dt: stores the samples of surfaces that a row during the step or at its end needs.
  void prepare_step(double dt);
  /// Called after a restart: measures the row of the checkpoint again if it was not complete.
  PetscErrorCode resume_row();
  /// Called in the middle of the next step, of dt: interpolates the waiting row between this middle and the last one;
  /// the next write_due() writes it.
  PetscErrorCode record_middle(double dt);
  /// Called later in that step, with its pressure and the velocity of its start: the same for flows through boundaries.
  PetscErrorCode record_pressure(double dt);
  /// Writes the row that waits if there is no next step.
  PetscErrorCode write_waiting();
  /// Returns the last row; null if it has been returned before.
  const Measured *new_row();
  /// One line, once per run, if a red cell or any body is strongly strained in the last row, or nothing.
  std::string strain_warning();
  /// Measures the state if it has not been measured yet.
  PetscErrorCode measure();
  /// The result of the last measure().
  const Measured &measured() const { return now_; }
  /// One line about bodies of a few cells at t = 0, which the guards ignore, or nothing. Collective, after measure().
  PetscErrorCode unresolved_bodies(std::string *line) const;
  /// Writes summary.json. Collective.
  PetscErrorCode write_summary(const RunSummary &run);
  /// The verdicts of the last summary.
  const std::vector<Verdict> &verdicts() const { return verdicts_; }

private:
  int few_cells() const { return domain_->dimension() == 3 ? 8 : 4; }
  bool resolved(double volume) const { return volume >= few_cells() * domain_->cell_volume(); }
  /// Returns the records of bodies, with the measured loads.
  std::vector<BodyRecord> records(const Measured &measured, const std::vector<BodyMeasure> &bodies,
                                  const std::vector<SurfaceMeasure> &surfaces) const;
  /// Totals over all ranks: bytes of fields, points where B is evolved, markers of membranes.
  struct Totals {
    double bytes, evolving, markers;
  };
  void add_progress(const RunSummary &run, const Totals &totals, Json *json) const;
  void add_measures(const EnergyBudget &budget, Json *json) const;
  PetscErrorCode list_bodies(std::vector<Json> *bodies) const;
  PetscErrorCode measure_largest(Measured *measured);
  double largest_stretch(const std::vector<BodyMeasure> &bodies, const std::vector<SurfaceMeasure> &surfaces,
                         std::size_t b) const;
  /// Writes snapshots of times within the last step.
  PetscErrorCode write_passed_snapshots(const std::vector<double> &times);
  PetscErrorCode measure_all(Measured *measured);
  PetscErrorCode measure_energy(Measured *measured);
  void set_energy_scales(EnergyState *energy) const;
  PetscErrorCode await_row(double time_before);
  PetscErrorCode record_power();
  /// Names and values of the columns of series.csv.
  std::vector<std::pair<std::string, double>> series_row(const Measured &row) const;
  PetscErrorCode write_row();
  PetscErrorCode write_row_now();
  EnergyBudget budget_now() const;

  static constexpr int most_bodies = 500;  ///< that summary.json lists
  Config config_;
  double probes_time_ = -1;                 ///< time up to which a continued run keeps its probes
  bool membranes_ = false, loads_ = false;  ///< whether there are such bodies, or bodies that bear loads
  const Domain *domain_ = nullptr;
  Solver *solver_ = nullptr;
  std::string directory_;
  Series series_;
  SampleFiles samples_;
  std::unique_ptr<BodiesFile> bodies_file_;
  BondFiles bond_files_;  ///< of a scene with adhesion
  std::unique_ptr<SnapshotWriter> snapshots_;
  Due series_due_, snapshot_due_;
  Measured now_;      ///< by the last measure()
  Measured row_;      ///< the waiting row, as measured in the middle of the last step; or the row to be written
  Measured written_;  ///< of the last row
  bool waits_ = false, seen_ = false, is_new_ = false;
  double series_time_before_ = -1;  ///< of the row before the one that waits
  std::string energy_unknown_;      ///< why the energy budget cannot be judged, or empty
  bool area_warned_ = false, stretch_warned_ = false;
  std::vector<Verdict> verdicts_;
  OutputsPosition position_;  ///< of the last sync(); energy, mach_max and bodies_rows: of the last row
};

}  // namespace eulastic
