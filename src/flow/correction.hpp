// What the pressure increment does: (8) and (9).
#pragma once

#include "base/petsc.hpp"
#include "field/field.hpp"

namespace eulastic {

namespace kernels {
struct AcmIncrement;
}

/// v* becomes v = v* - dt/rho grad(increment) (9) and p += increment - rotation D*, the latter in one ghost layer too
/// (8). rotation = nu/2 is the rotational form of the second-order step, 0 the paper's. Rows of v are wrapped by three
/// around a periodic x.
PetscErrorCode correct_velocity(const Box &box, double density, double dt, double rotation, const Field &increment,
                                const Field &divergence, Field &velocity, Field &pressure);
/// The same with an increment that is stored nowhere; one ghost of D* and p.
PetscErrorCode correct_velocity(const Box &box, double density, double dt, double rotation,
                                const kernels::AcmIncrement &increment, const Field &divergence, Field &velocity,
                                Field &pressure);

}  // namespace eulastic
