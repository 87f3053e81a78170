// Copies between fields and global Vecs of a DMDA, for PETSc's solvers and viewers.
#pragma once

#include "base/petsc.hpp"
#include "grid/domain.hpp"

namespace eulastic {

/// Copies the owned values of a field to a global Vec of Domain::dm(), which includes the faces on high boundaries, or
/// of a DMDA made by Domain::create_cell_dm(), which has only the cells.
PetscErrorCode to_global(const Domain &domain, ConstView field, Vec vector);
/// Copies a global Vec to the owned values of a field; ghosts do not change.
PetscErrorCode from_global(const Domain &domain, Vec vector, View field);

}  // namespace eulastic
