// A field as a Vec of the grid's DMDA, for PETSc's solvers and viewers.
#pragma once

#include "base/petsc.hpp"
#include "grid/domain.hpp"

namespace eulastic {

/// Copies what the rank owns: cells only, index N of a wall direction is in no Vec. `vector` is of DMCreateGlobalVector
/// for the DMDA of the grid, or another of the same split.
PetscErrorCode to_global_vector(const Domain &domain, ConstView field, Vec vector);
PetscErrorCode from_global_vector(const Domain &domain, Vec vector, View field);

}  // namespace eulastic
