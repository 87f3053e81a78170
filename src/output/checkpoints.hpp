// When a run writes checkpoints, how many stay, and when somebody wants it to end.
#pragma once

#include "base/petsc.hpp"
#include "output/due.hpp"
#include "output/restart.hpp"
#include "output/saved_state.hpp"

namespace eulastic {

class Checkpoints {
public:
  /// `goes_on`: from a checkpoint in `directory`.
  void start(const ParseResult &parsed, const std::string &directory, Solver *solver, Outputs *outputs, Guards *guards,
             bool goes_on);
  /// The run has been accepted; its files are in `directory`. Checkpoints younger than the one it goes on from, which
  /// belong to a run that is no more, are removed.
  void accept(const std::string &directory);

  /// Collective, after a step and what it made due. Writes a checkpoint if one is due by simulated time or by rank 0's
  /// clock, or if the run has to end: then `exit_reason` is "signal" or "wall_limit". A state that the guards do not
  /// let pass is not written: the last good one stays.
  PetscErrorCode after_step(const RunPosition &position, std::string *exit_reason, Stop *stop);
  /// Collective. The last one of a run that writes any.
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
