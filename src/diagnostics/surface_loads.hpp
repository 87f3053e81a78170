// What the fluid exerts on elastic vessels and obstacles: the integral of the whole stress over their surface, as
// -sigma.grad(phi) over the box (docs/method.md, section 14). Rigid bodies: rigid/rigid_surfaces.hpp.
#pragma once

#include "base/petsc.hpp"
#include "field/phase.hpp"
#include "flow/local_viscosity.hpp"

namespace eulastic {

struct SurfaceLoad {
  int label = 0;   ///< of the body
  Real3 centre{};  ///< that torque is about
  Real3 force{};   ///< the pressure of a uniform body force not included; per depth in 2-D
  Real3 torque{};
};

/// An elastic body in a box of its own, with the surfaces that bear loads where it is.
struct BodyAtSurfaces {
  const Phase *phase;
  Box box;                      ///< its cells and one around them
  Int3 first;                   ///< the first of them in the box of the phase
  std::vector<Field> surfaces;  ///< of every phase that bears loads: labels and phi, with one ghost behind sides
};

/// Measures the loads of bodies whose label and centre are given; `labels`: of every phase, null where none of them is
/// in it, else one field; `bodies`: of this rank, whose stress comes on top of that of the phases. One ghost of
/// velocity, pressure, phi, B and labels. Exact sums: the same bits on any ranks.
PetscErrorCode measure_surface_loads(MPI_Comm comm, const EdgeViscosity &viscosity, const Field &velocity,
                                     const Field &pressure, const std::vector<Phase> &phases,
                                     const std::vector<const Field *> &labels,
                                     const std::vector<BodyAtSurfaces> &bodies, std::vector<SurfaceLoad> *loads);

}  // namespace eulastic
