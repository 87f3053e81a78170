// The points of surfaces on the grid, of rigid bodies and of elastic ones that are anchored, that receptors are nearest
// to.
#pragma once

#include "field/phase.hpp"
#include "grid/domain.hpp"

#include <vector>

namespace eulastic {

/// How far such a point may be away, in cells.
inline constexpr int foot_reach = 2;

/// A point that a receptor may bind to.
struct Foot {
  Real3 place{};
  bool found = false;  ///< false: there is none within reach
};

/// The nearest point of the surface phi = 1/2 of a phase to a place, which need not be wrapped around periodic sides,
/// on the rank that owns its cell; in each cut cell the surface is a plane. Three ghosts of phi.
Foot find_foot(const Domain &domain, const Phase &phase, const Real3 &place);

/// Whether the surface crosses owned cells that lie in a block, which need not be wrapped.
bool has_surface_in(const Domain &domain, const Phase &phase, const Extent &block);

}  // namespace eulastic
