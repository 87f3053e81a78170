// Bodies that are placed over each other.
#pragma once

#include "bodies/placement.hpp"
#include "grid/voxels.hpp"

#include <cstdint>
#include <vector>

namespace eulastic {

/// Two bodies, by their labels: 1, 2, ... through all species, a body from a file being one.
struct Overlap {
  int body = 0, other = 0;  ///< body < other; 0 = none
  double volume = 0;        ///< that they share, at least: the sum of what is above 1 in a cell; area in 2-D
};

/// Whether bodies b = 1, 2, ... overlap any other: in some cell their solid fractions add up to more than 1.01, which
/// bodies that touch do not. Looked at are part `part` of `parts` of the bodies, each with all before it; all parts
/// together find all bodies, and the first pair is that of one of them. No pairs of: two attached bodies, which is how
/// walls are joined; bodies of one species with -NAME_contact merge, which are one; a body at random and one before
/// it; bodies from files (add_shared). Communicates nothing.
std::vector<char> find_overlaps(const std::vector<SpeciesSpec> &species,
                                const std::vector<std::vector<BodyPlace>> &places, const GridSpec &grid, int part,
                                int parts, Overlap *first);

/// What bodies share with a solid: volumes in 2^-30 cells, to be added without round-off, and whether they overlap.
struct SharedVolumes {
  std::vector<std::int64_t> volume;
  std::vector<char> overlaps;
};

/// Adds what the bodies of a species share with the solid of `fraction` in layers of the box. Sizes as `places`.
void add_shared(const SpeciesSpec &spec, const std::vector<BodyPlace> &places, const GridSpec &grid,
                const CellWindow &layers, ConstView fraction, SharedVolumes *shared);

}  // namespace eulastic
