// Regular packings of one species: the lattice sites on which the most bodies fit.
#pragma once

#include "bodies/crowd.hpp"
#include "bodies/region.hpp"

namespace eulastic {

/// Returns sites for `shape` in the part of `region` that `crowd` leaves free; bodies on them do not overlap. It is the
/// first packing found with at least `enough` sites, otherwise the one with the most. Packings are rows of bounding
/// boxes and staggered rows, with each of `orientations` (degrees), and in the lumen of a tube at several offsets.
std::vector<BodyPlace> find_packing(const Region &region, const Crowd &crowd, const DomainShape &grid,
                                    const ConvexBody &shape, const std::vector<Real3> &orientations,
                                    std::size_t enough);

}  // namespace eulastic
