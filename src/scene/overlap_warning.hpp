// Warns of overlapping bodies, or refuses bodies at the same position.
#pragma once

#include "base/petsc.hpp"
#include "scene/config.hpp"

namespace eulastic {

/// Collective. `warning`: one line with the number of overlapping bodies, the first pair and a remedy; empty without
/// overlaps (bodies/overlap.hpp), or with -initial_state, which may define bodies of its own. `refusal`: one line if
/// two bodies are at the same position, and then no warning. The same on any number of ranks.
PetscErrorCode find_overlap(MPI_Comm comm, const Config &config, std::string *warning, std::string *refusal);

}  // namespace eulastic
