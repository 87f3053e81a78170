// B is symmetric and positive definite. Where the grid does not resolve it, the transported one need not be, and a
// body that yields energy when it is stretched blows up: docs/method.md, section 7.
#pragma once

#include "base/petsc.hpp"
#include "solids/transport.hpp"

namespace eulastic {

/// B_ab^2 <= B_aa B_bb on the edges that evolve, with the means of the diagonal over the four centres around them. The
/// diagonal itself is kept above 0 by transport_tensor(). Needs B at the centres in one ghost layer, where an edge
/// beside them evolves; phi in one.
PetscErrorCode limit_shear(const Box &box, const Phase &phase, Field &tensor);

}  // namespace eulastic
