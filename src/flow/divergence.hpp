// The divergence that the projection removes.
#pragma once

#include "base/petsc.hpp"
#include "field/field.hpp"

namespace eulastic {

/// D* = rho div v* at centres. Needs one ghost of v*. Rows are wrapped by one around a periodic x.
PetscErrorCode compute_divergence(const Box &box, double density, const Field &velocity_star, Field &divergence);

}  // namespace eulastic
