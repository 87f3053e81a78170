// What the deviatoric stress of varying viscosity does outside the viscous stages: its force, and the pressure update.
#pragma once

#include "base/petsc.hpp"
#include "flow/viscosity.hpp"

namespace eulastic {

/// out += scale div(tau(v))/rho at owned faces; two ghosts of v, corners included. `viscosity`: compute_viscosity().
PetscErrorCode add_viscous_force(const Box &box, LocalViscosity &viscosity, double scale, const Field &velocity,
                                 Field &out);

/// p -= factor nu D*, in one ghost layer too: the rotational update where nu is that of the place.
PetscErrorCode rotate_pressure(const Box &box, const Field &viscosity, double factor, const Field &divergence,
                               Field &pressure);

}  // namespace eulastic
