// A field as a global Vec of a DMDA, for PETSc's solvers and viewers.
#pragma once

#include "base/petsc.hpp"
#include "grid/domain.hpp"

namespace eulastic {

/// Copies the owned values of a field, row by row, to a global Vec: of Domain::dm(), which has the points of faces on
/// high sides, or of a DMDA that Domain::create_cell_dm has made, which has the cells alone.
PetscErrorCode to_global(const Domain &domain, ConstView field, Vec vector);
/// The same back; ghosts are not touched.
PetscErrorCode from_global(const Domain &domain, Vec vector, View field);

}  // namespace eulastic
