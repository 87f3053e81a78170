// Loads of the fluid on elastic vessels and obstacles: the integral of the whole stress over their surface, computed as
// -sigma.grad(phi) over the box (docs/method.md, section 14). For rigid bodies see rigid/rigid_impulse.hpp.
#pragma once

#include "base/petsc.hpp"
#include "field/phase.hpp"
#include "flow/local_viscosity.hpp"

namespace eulastic {

struct SurfaceLoad {
  int label = 0;   ///< of the body
  Real3 centre{};  ///< centre for the torque
  Real3 force{};   ///< without the pressure of a uniform body force; in 2-D per depth
  Real3 torque{};
};

/// An elastic body in a box of its own, with the surfaces around it that bear loads.
struct BodyAtSurfaces {
  const Phase *phase;
  Box box;     ///< its cells and one layer around them
  Int3 first;  ///< index of its first cell in the box of the phase
  /// Labels and phi of every phase that bears loads, with one ghost layer behind boundaries.
  std::vector<Field> surfaces;
};

/// Measures the loads of bodies whose label and centre are given. `labels`: of every phase, null if none of these
/// bodies is in it. `bodies`: bodies of this rank in boxes, whose stress is added to that of the phases. Reads one
/// ghost of velocity, pressure, phi, B and labels. Sums are exact, so that the bits do not depend on the ranks.
/// Collective.
PetscErrorCode measure_surface_loads(MPI_Comm comm, const EdgeViscosity &viscosity, const Field &velocity,
                                     const Field &pressure, const std::vector<Phase> &phases,
                                     const std::vector<const Field *> &labels,
                                     const std::vector<BodyAtSurfaces> &bodies, std::vector<SurfaceLoad> *loads);

}  // namespace eulastic
