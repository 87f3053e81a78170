// Starts the threads of a rank and chooses how they wait for work, from the processors of the node.
#pragma once

#include "base/petsc.hpp"

#include <string>

namespace eulastic {

/// Starts the threads of this rank. They spin where the ranks of a node may use as many processors as they have threads
/// together, and this rank has at least `threads`; elsewhere they sleep. The environment variable EULASTIC_WAIT, "spin"
/// or "sleep", overrides that. `line`: says how threads wait and why; empty with one thread. `warning`: this rank has
/// more threads than it may use processors, or empty. `refusal`: EULASTIC_WAIT has another value, or empty. Collective;
/// ranks of different nodes may choose differently.
PetscErrorCode start_threads(int threads, std::string *line, std::string *warning, std::string *refusal);

}  // namespace eulastic
