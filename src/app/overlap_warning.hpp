// The warning of bodies that are placed over each other.
#pragma once

#include "app/config.hpp"
#include "base/petsc.hpp"

namespace eulastic {

/// Collective: one line that says how many bodies overlap, which is the first pair and what to do; empty if none does
/// (bodies/overlap.hpp), or with -initial_state, which may bring bodies of its own. The same on any number of ranks.
PetscErrorCode find_overlap_warning(MPI_Comm comm, const Config &config, std::string *warning);

}  // namespace eulastic
