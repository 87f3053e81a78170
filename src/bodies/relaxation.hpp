// Crowds that are denser than what fits at random: smaller bodies on the sites of a regular packing grow to their size
// while they move and turn at random and push each other away.
#pragma once

#include "bodies/crowd.hpp"
#include "bodies/region.hpp"

namespace eulastic {

/// Places `count` bodies of one species, of `shape`, in `region`, clear of each other and of `others`; `orientations`
/// and what they mean as for find_packing(). Depends on nothing but the arguments. Returns how many of them are clear:
/// all, or where they do not fit in some 1e7 moves, some minutes for 10 000 bodies, those that are left when bodies
/// that overlap are taken away. Bodies far above what fits are not tried: 0.
std::size_t relax_crowd(const SpeciesSpec &spec, const DomainShape &grid, const Region &region, const Crowd &others,
                        const std::vector<Real3> &orientations, std::size_t count, std::vector<BodyPlace> *places);

}  // namespace eulastic
