// Predicts the load balance at the start of a run for -check_only, by the algorithm that assigns bodies to ranks.
#pragma once

#include "base/petsc.hpp"
#include "scene/config.hpp"

#include <string>

namespace eulastic {

/// Collective over `comm`, whose ranks know their shares of the places. `line`: the work of a step on the fullest of
/// `ranks` planned ranks over the mean, in units of flow_work (boxes/share_out.hpp), once bodies in boxes are shared
/// out at the start; empty on one rank and where no bodies lie in boxes. No field is created and nothing is read from
/// files: where bodies come from one it is "unknown".
PetscErrorCode describe_work(MPI_Comm comm, const Config &config, int ranks, std::string *line);

}  // namespace eulastic
