// Saves the state of a run in a checkpoint and loads it.
#pragma once

#include "base/petsc.hpp"
#include "io/checkpoint.hpp"
#include "output/outputs.hpp"

namespace eulastic {

/// State of a run beside the solver's; the same on all ranks.
struct RunPosition {
  double dt = 0;                                    ///< of the time step control
  double wall_seconds = 0, wall_seconds_total = 0;  ///< of all runs that led here
  std::int64_t stages = 0, sweeps = 0;              ///< viscous stages and pressure iterations of these runs
  OutputsPosition outputs;
};

/// Collective. Rank-independent 64-bit hash of all that a checkpoint holds of the solver: fields, markers and numbers.
PetscErrorCode state_hash(Solver *solver, std::uint64_t *hash);
/// Collective.
PetscErrorCode save_state(Solver *solver, const RunPosition &position, const std::string &options,
                          const std::string &path);
/// Collective. Loads a checkpoint into a solver whose scene has been built from the same options, and makes it ready to
/// continue. After an error the solver contains parts of the file; another file may then be loaded over it.
PetscErrorCode load_state(CheckpointFile *file, const std::string &path, Solver *solver, RunPosition *position);

}  // namespace eulastic
