// The correction of velocity and pressure by the pressure increment: (8) and (9).
#pragma once

#include "base/petsc.hpp"
#include "field/field.hpp"

namespace eulastic {

namespace kernels {
struct AcmIncrement;
}

/// Corrects v* to v* - dt/rho grad(increment), (9), on owned faces, and p by increment - rotation D*, (8), also in one
/// ghost layer. rotation = nu/2 is the rotational update of the fast method (docs/method.md, section 4), 0 the paper's
/// update. `increment` and `divergence` need one ghost.
PetscErrorCode correct_velocity(const Box &box, double density, double dt, double rotation, const Field &increment,
                                const Field &divergence, Field &velocity, Field &pressure);
/// The same with an increment given by a formula and not stored. D* and p need one ghost.
PetscErrorCode correct_velocity(const Box &box, double density, double dt, double rotation,
                                const kernels::AcmIncrement &increment, const Field &divergence, Field &velocity,
                                Field &pressure);

}  // namespace eulastic
