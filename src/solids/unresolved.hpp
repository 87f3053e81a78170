// Where the grid does not resolve B it is mended or forgotten: docs/method.md, section 7.
#pragma once

#include "base/petsc.hpp"
#include "grid/domain.hpp"
#include "solids/transport.hpp"

namespace eulastic {

/// Largest det B that is taken for one; where B is reset outside, as the classic method does, in full cells, at the
/// surface, and where less than half is solid: little stress, and all that its smeared surface ever was. (5) keeps it
/// 1; a mean of unlike tensors has more.
inline constexpr double largest_determinant = 3.5, largest_at_surface = 8, largest_outside = 30, full_cell = 0.999;

/// Whether det B may be too large anywhere in a body with tr B <= trace: det B <= (tr B/3)^3, in 2-D ((tr B - 1)/2)^2.
bool may_be_unresolved(double trace, int dimension);

/// Of the centres that evolve with a det B above these limits, off-diagonals averaged from the edges: where B is
/// extended, the diagonals get the factor that makes det B 1. Where it is reset, B = I there and B_ab = 0 on the edges
/// around; full cells that exceed their limit then, as neighbours of those, get such a factor. Only owned points; what
/// is extended from them is not made anew. Returns how many such centres the box has. Two ghosts of B, one of phi.
long forget_unresolved(const Box &box, Phase &phase);
/// The same of all ranks. Collective.
PetscErrorCode forget_unresolved(const Domain &domain, Phase &phase, long *count);

/// The same, if the largest trace leaves room for it.
inline PetscErrorCode find_and_forget(const Domain &box, double trace, Phase &phase, long *count) {
  *count = 0;
  return may_be_unresolved(trace, box.dimension()) ? forget_unresolved(box, phase, count) : 0;
}

}  // namespace eulastic
