// A field at centres as a global Vec of the DMDA of the cells, for PETSc's solvers and viewers.
#pragma once

#include "base/petsc.hpp"
#include "grid/domain.hpp"

namespace eulastic {

/// Copies the owned cells of a field, row by row. `vector` must come from DMCreateGlobalVector of a DMDA that
/// Domain::create_cell_dm made, which has no point N.
PetscErrorCode to_global(const Domain &domain, ConstView field, Vec vector);
PetscErrorCode from_global(const Domain &domain, Vec vector, View field);

}  // namespace eulastic
