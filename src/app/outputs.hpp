// What a run leaves behind: series.csv, bodies.h5, snapshots, summary.json. Looks at the state, never touches it.
#pragma once

#include "app/config.hpp"
#include "diagnostics/flow_measures.hpp"
#include "io/bodies_file.hpp"
#include "io/series.hpp"
#include "io/snapshot.hpp"
#include "io/snapshot_fields.hpp"
#include "io/summary.hpp"
#include "solver/solver.hpp"

#include <memory>

namespace eulastic {

class Outputs {
public:
  /// Opens the files in `directory`, which exists and is ours.
  PetscErrorCode open(const Config &config, const Grid &grid, Solver *solver, const std::string &directory);
  /// Writes whatever has become due: the first state at or after each multiple of the interval, with its true time.
  PetscErrorCode write_due(bool last);
  /// summary.json; `summary` comes with what the time loop knows, the rest is filled in here.
  PetscErrorCode write_summary(Summary summary);

private:
  /// The next multiple of an interval, passed or not.
  struct Due {
    double interval = 0, next = 0;
    bool now(double time, bool last);
    double last_time = -1;
  };
  PetscErrorCode measure();
  std::vector<BodyRecord> records() const;

  Config config_;
  const Grid *grid_ = nullptr;
  Solver *solver_ = nullptr;
  std::string directory_;
  Series series_;
  std::unique_ptr<BodiesFile> bodies_file_;
  std::unique_ptr<SnapshotWriter> snapshots_;
  std::unique_ptr<SnapshotFields> snapshot_fields_;
  Due series_due_, snapshot_due_;
  FlowMeasures flow_;
  std::vector<BodyMeasure> bodies_;
  std::vector<double> first_volume_;
  double measured_time_ = -1, mach_max_ = 0, volume_drift_ = 0;
};

}  // namespace eulastic
