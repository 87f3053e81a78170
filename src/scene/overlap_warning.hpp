// The warning or refusal of bodies that are placed over each other.
#pragma once

#include "base/petsc.hpp"
#include "scene/config.hpp"

namespace eulastic {

/// Collective. `warning`: one line that says how many bodies overlap, which is the first pair and what to do; empty if
/// none does (bodies/overlap.hpp), or with -initial_state, which may bring bodies of its own. `refusal`: one line if
/// two bodies are at the same place, and then no warning. The same on any number of ranks.
PetscErrorCode find_overlap(MPI_Comm comm, const Config &config, std::string *warning, std::string *refusal);

}  // namespace eulastic
