// The points nearest to receptors on surfaces on the grid: those of rigid and of anchored elastic bodies.
#pragma once

#include "field/phase.hpp"
#include "grid/domain.hpp"

#include <vector>

namespace eulastic {

/// Largest distance of such a point, in cells.
inline constexpr int foot_reach = 2;

/// A point that a receptor may bind to.
struct Foot {
  Real3 place{};
  bool found = false;  ///< whether there is one within reach
};

/// Returns the point of a phase's surface phi = 1/2 nearest to a position, which need not be wrapped into the domain.
/// In each cut cell the surface is a plane. Call it on the rank that owns the cell; three ghost layers of phi.
Foot find_foot(const Domain &domain, const Phase &phase, const Real3 &place);

/// Returns whether the surface cuts owned cells of a block, which need not be wrapped.
bool has_surface_in(const Domain &domain, const Phase &phase, const Extent &block);

}  // namespace eulastic
