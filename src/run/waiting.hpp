// Chooses how the threads of this run wait for work, from the processors of the node.
#pragma once

#include "base/petsc.hpp"
#include "base/team.hpp"

#include <string>

namespace eulastic {

struct WaitingChoice {
  Waiting how = Waiting::sleep;
  std::string line;     ///< says how threads wait and why; empty with one thread per rank
  std::string warning;  ///< more threads than this rank may use processors; else empty
  std::string error;    ///< what EULASTIC_WAIT has that is not accepted; else empty
};

/// Threads spin where the ranks of a node may use as many processors as they have threads together, and this rank has
/// at least `threads`; elsewhere they sleep. `wanted`: of the environment variable EULASTIC_WAIT, "spin" or "sleep",
/// which overrides that, or empty. Collective; ranks of different nodes may choose differently.
PetscErrorCode choose_waiting(MPI_Comm comm, int threads, const std::string &wanted, WaitingChoice *choice);

}  // namespace eulastic
