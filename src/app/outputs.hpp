// What a run leaves behind: series.csv, bodies.h5, snapshots, summary.json. Looks at the state, never touches it.
#pragma once

#include "app/config.hpp"
#include "app/due.hpp"
#include "app/guards.hpp"
#include "app/sample_files.hpp"
#include "app/snapshot_output.hpp"
#include "app/vessels.hpp"
#include "diagnostics/energy_budget.hpp"
#include "diagnostics/side_flows.hpp"
#include "io/bodies_file.hpp"
#include "io/series.hpp"
#include "io/summary.hpp"
#include "solver/solver.hpp"

#include <memory>

namespace eulastic {

/// How far the files of a run have come: what a restart needs to go on with them.
struct OutputsPosition {
  long series_rows = 0, bodies_rows = 0, snapshots = 0;
  double series_time = -1, snapshot_time = -1, profile_time = -1;  ///< of the last one; negative: none yet
  EnergyBudget energy;
  double mach_max = 0;
};

class Outputs {
public:
  /// Can measure from here on. `position`: how far the run had come that goes on.
  void start(const Config &config, const Grid &grid, Solver *solver, const OutputsPosition &position);
  /// Opens the files in `directory`, which exists and is ours. In that of a run that goes on its files are cut back to
  /// `position`.
  PetscErrorCode open(const std::string &directory, const OutputsPosition &position, bool same_directory);
  /// Rank 0 has moved the files.
  void moved_to(const std::string &directory);
  /// Brings all rows to the disk and says how far they are.
  PetscErrorCode sync(OutputsPosition *position);
  /// Writes whatever has become due: the first state at or after each multiple of the interval, with its true time.
  PetscErrorCode write_due(bool last);
  /// Measures the state, if that has not been done.
  PetscErrorCode measure();
  /// As of the last measure(), which every row of series.csv makes.
  const Measured &measured() const { return measured_; }
  /// One line about bodies of a few cells at t = 0, which no guard looks at, or nothing. Collective, after measure().
  PetscErrorCode unresolved_bodies(std::string *line) const;
  /// summary.json; `summary` comes with what the time loop knows, the rest is filled in here.
  PetscErrorCode write_summary(Summary summary);

private:
  int few_cells() const { return grid_->dimension() == 3 ? 8 : 4; }
  bool resolved(double volume) const { return volume >= few_cells() * grid_->cell_volume(); }
  /// Of these bodies, with what else is measured of them.
  std::vector<BodyRecord> records(const std::vector<BodyMeasure> &bodies,
                                  const std::vector<SurfaceMeasure> &surfaces) const;
  PetscErrorCode list_bodies(Summary *summary) const;
  PetscErrorCode measure_drift();
  /// Of times within the last step.
  PetscErrorCode write_passed_snapshots(const std::vector<double> &times);
  PetscErrorCode measure_energy(EnergyState *energy);
  PetscErrorCode write_series();

  Config config_;
  bool membranes_ = false;
  const Grid *grid_ = nullptr;
  Solver *solver_ = nullptr;
  std::string directory_;
  Series series_;
  SampleFiles samples_;
  std::unique_ptr<BodiesFile> bodies_file_;
  std::unique_ptr<SnapshotOutput> snapshots_;
  Due series_due_, snapshot_due_;
  Measured measured_;
  std::vector<SideFlow> sides_;  ///< as of the last measure_energy()
  EnergyBudget energy_;
  long bodies_rows_ = 0, snapshots_before_ = 0;
  double mach_max_ = 0;
};

}  // namespace eulastic
