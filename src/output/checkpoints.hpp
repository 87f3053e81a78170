// Schedules checkpoints, removes old ones, and ends the run on signals and time limits.
#pragma once

#include "base/petsc.hpp"
#include "output/due.hpp"
#include "output/restart.hpp"
#include "output/saved_state.hpp"

namespace eulastic {

class Checkpoints {
public:
  /// `goes_on`: whether the run continues from a checkpoint in `directory`.
  void start(const ParseResult &parsed, const std::string &directory, Solver *solver, Outputs *outputs, Guards *guards,
             bool goes_on);
  /// The run has been accepted; its files are in `directory`. Checkpoints newer than the one it continues from belong
  /// to a discarded run and are removed.
  void accept(const std::string &directory);

  /// Collective, after a step and its outputs. Writes a checkpoint if one is due by simulated time or by rank 0's
  /// clock, or if the run has to end: then `exit_reason` is "signal" or "wall_limit". A state that the guards refuse is
  /// not written, so that the last good checkpoint is kept.
  PetscErrorCode after_step(const RunPosition &position, std::string *exit_reason, Stop *stop);
  /// Collective. Writes the last checkpoint of a run, if it writes any.
  PetscErrorCode before_end(const RunPosition &position, Stop *stop);
  /// The newest one in the directory, its name without it; empty = none. Known to all ranks.
  std::string newest() const;

private:
  PetscErrorCode write(RunPosition position, Stop *stop);
  PetscErrorCode remove_old();
  int wishes() const;  ///< of this rank

  CheckpointControl control_;
  std::string directory_, options_;
  Solver *solver_ = nullptr;
  Outputs *outputs_ = nullptr;
  Guards *guards_ = nullptr;
  Due due_;
  double begin_ = 0, last_wall_ = 0;  ///< MPI_Wtime
  std::int64_t last_step_ = -1;       ///< that has a checkpoint in this directory
  bool goes_on_ = false;
};

}  // namespace eulastic
