// Regular packings of one species: where the most bodies fit.
#pragma once

#include "bodies/crowd.hpp"
#include "bodies/region.hpp"

namespace eulastic {

/// Sites for `shape` in the free part of `region`, no two in each other's way: the first packing found with at least
/// `enough`, else the one with the most. Tried: rows of boxes and staggered rows, with each of `orientations`, in the
/// lumen of a tube in several positions.
std::vector<BodyPlace> find_packing(const Region &region, const Crowd &crowd, const DomainShape &grid,
                                    const ConvexBody &shape, const std::vector<Real3> &orientations,
                                    std::size_t enough);

}  // namespace eulastic
