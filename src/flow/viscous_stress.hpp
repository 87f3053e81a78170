// What the deviatoric stress of varying viscosity does: its force, super time stepping with it, and the pressure
// update.
#pragma once

#include "base/petsc.hpp"
#include "flow/super_time_stepping.hpp"
#include "flow/viscosity.hpp"

namespace eulastic {

/// out += scale div(tau(v))/rho at owned faces; two ghosts of v, corners included. `viscosity`: compute_viscosity().
PetscErrorCode add_viscous_force(const Box &box, LocalViscosity &viscosity, double scale, const Field &velocity,
                                 Field &out);

/// super_time_step() with this stress for the Laplacian: its components see each other, so that ghosts are exchanged
/// before every stage. Cut faces of rigid bodies have the kinematic viscosity of the fluid beside them.
PetscErrorCode super_time_step(const Box &box, GhostExchange &exchange, const BoxSides &box_sides,
                               LocalViscosity &viscosity, double time, double dt, int stages, const Field &velocity,
                               SuperTimeStepping &work, Field &velocity_star, const RigidFaces *rigid = nullptr,
                               double viscosity_beside_rigid = 0, RigidMeans *means = nullptr);

/// p -= factor nu D*, in one ghost layer too: the rotational update where nu is that of the place.
PetscErrorCode rotate_pressure(const Box &box, const Field &viscosity, double factor, const Field &divergence,
                               Field &pressure);

}  // namespace eulastic
