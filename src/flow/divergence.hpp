// The divergence of the predicted velocity, which the projection removes.
#pragma once

#include "base/petsc.hpp"
#include "field/field.hpp"

namespace eulastic {

/// Computes D* = rho div v* at the owned centres. v* needs one ghost.
PetscErrorCode compute_divergence(const Box &box, double density, const Field &velocity_star, Field &divergence);

}  // namespace eulastic
