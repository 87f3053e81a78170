// Repair of B where the grid does not resolve it: docs/method.md, section 7.
#pragma once

#include "base/petsc.hpp"
#include "grid/domain.hpp"
#include "solids/transport.hpp"

namespace eulastic {

/// Largest det B that is accepted. By (5) it is 1; a mean of different tensors has more. Where B is reset outside
/// bodies (classic method) there are three limits: for full cells, for the surface, and for cells that are less than
/// half solid, where the stress is small and B is always smeared.
inline constexpr double largest_determinant = 3.5, largest_at_surface = 8, largest_outside = 30, full_cell = 0.999;

/// Whether det B may exceed the limit in a body with tr B <= trace, as det B <= (tr B/3)^3, in 2-D ((tr B - 1)/2)^2.
bool may_be_unresolved(double trace, int dimension);

/// Repairs the evolving centres whose det B exceeds its limit, off-diagonals averaged from the edges. Where B is
/// extrapolated, the diagonals are multiplied by the factor that makes det B = 1. Where B is reset outside, B = I there
/// and B_ab = 0 on the edges around; full neighbours that then exceed their limit get such a factor. Changes owned
/// points only and does not repeat the extrapolation. Returns the number of such centres in the box. Reads two ghosts
/// of B and one of phi.
long reset_unresolved(const Box &box, Phase &phase);
/// Does the same on all ranks; *count is the total. Collective.
PetscErrorCode reset_unresolved(const Domain &domain, Phase &phase, long *count);

/// Does the same, if a largest trace of `trace` makes it necessary.
inline PetscErrorCode find_and_repair(const Domain &box, double trace, Phase &phase, long *count) {
  *count = 0;
  return may_be_unresolved(trace, box.dimension()) ? reset_unresolved(box, phase, count) : 0;
}

}  // namespace eulastic
