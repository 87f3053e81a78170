// A field at centres as a Vec of the DMDA of the cells, for PETSc's solvers and viewers.
#pragma once

#include "base/petsc.hpp"
#include "grid/domain.hpp"

namespace eulastic {

/// Copies the cells that the rank owns. `vector` was made by DMCreateGlobalVector for a DMDA of
/// Domain::create_cell_dm, which has no point N.
PetscErrorCode to_global_vector(const Domain &domain, ConstView field, Vec vector);
PetscErrorCode from_global_vector(const Domain &domain, Vec vector, View field);

}  // namespace eulastic
