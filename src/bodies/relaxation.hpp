// Crowds that are denser than random insertion reaches: bodies start smaller on the sites of a regular packing and grow
// to full size while they move and turn at random and push each other apart.
#pragma once

#include "bodies/crowd.hpp"
#include "bodies/region.hpp"

namespace eulastic {

/// Places `count` bodies of one species in `region`, free of overlap with each other and with `others`. `orientations`
/// are those of find_packing(). The result depends on the arguments alone. Returns the number of bodies without
/// overlap: `count`, or, if about 1e7 moves (minutes for 10,000 bodies) do not suffice, the number that remains after
/// overlapping bodies are removed. Returns 0 at once for volume fractions far above what fits.
std::size_t relax_crowd(const SpeciesSpec &spec, const DomainShape &grid, const Region &region, const Crowd &others,
                        const std::vector<Real3> &orientations, std::size_t count, std::vector<BodyPlace> *places);

}  // namespace eulastic
