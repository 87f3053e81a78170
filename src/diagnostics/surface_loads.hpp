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

/// Measures the loads of bodies whose label and centre are given; `labels`: of every phase, null where none of them is
/// in it, else one field. One ghost of velocity, pressure, phi, B and labels. Exact sums: the same bits on any ranks.
PetscErrorCode measure_surface_loads(MPI_Comm comm, const EdgeViscosity &viscosity, const Field &velocity,
                                     const Field &pressure, const std::vector<Phase> &phases,
                                     const std::vector<const Field *> &labels, std::vector<SurfaceLoad> *loads);

}  // namespace eulastic
