// The deviatoric stress with variable viscosity outside the viscous stages: its force, and the rotational update.
#pragma once

#include "base/petsc.hpp"
#include "flow/viscosity.hpp"

namespace eulastic {

/// Adds scale div(tau(v))/rho to `out` at owned faces. v needs two ghosts, including corners. `viscosity`: from
/// compute_viscosity().
PetscErrorCode add_viscous_force(const Box &box, LocalViscosity &viscosity, double scale, const Field &velocity,
                                 Field &out);

/// Subtracts factor nu D* with the local nu from the pressure, also in one ghost layer: the rotational update with
/// variable viscosity.
PetscErrorCode apply_rotational_update(const Box &box, const Field &viscosity, double factor, const Field &divergence,
                                       Field &pressure);

}  // namespace eulastic
