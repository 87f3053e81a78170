// B is symmetric and positive definite. The transported B may lose this where the grid does not resolve it, and a body
// that releases energy when it is stretched is unstable: docs/method.md, section 7.
#pragma once

#include "base/petsc.hpp"
#include "solids/transport.hpp"

namespace eulastic {

/// Enforces B_ab^2 <= B_aa B_bb on evolving edges, with the means of the diagonals over the four centres around;
/// transport_tensor() keeps the diagonals themselves >= 0. Reads B at centres in one ghost layer, where an edge beside
/// them evolves, and one ghost of phi.
PetscErrorCode limit_shear(const Box &box, const Phase &phase, Field &tensor);

}  // namespace eulastic
