// The points of surfaces on the grid, of rigid bodies and of elastic ones that are anchored, that receptors are nearest
// to.
#pragma once

#include "field/phase.hpp"
#include "grid/domain.hpp"

#include <vector>

namespace eulastic {

/// How far such a point may be away, in cells.
inline constexpr int foot_reach = 2;

struct Foot {
  Real3 place{};
  double found = 0;  ///< 1; 0: the surface is not within reach
};

/// The nearest points of the surface phi = 1/2 of a phase to places that are `wanted`, which need not be wrapped around
/// periodic sides; in each cut cell the surface is a plane. Three ghosts of phi. Collective, the same on all ranks.
PetscErrorCode find_feet(const Domain &domain, const Phase &phase, const std::vector<Real3> &places,
                         const std::vector<char> &wanted, std::vector<Foot> *feet);

}  // namespace eulastic
