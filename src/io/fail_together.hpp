// Errors of one rank made everybody's: all ranks return the same message, nobody waits for one that has left.
#pragma once

#include "base/petsc.hpp"

#include <string>

namespace eulastic {

/// Collective. Succeeds if `problem` is empty on every rank; else fails on all with the text of the lowest rank.
PetscErrorCode fail_together(MPI_Comm comm, const std::string &problem);

}  // namespace eulastic
