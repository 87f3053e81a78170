// Bodies that are placed over each other.
#pragma once

#include "base/body_range.hpp"
#include "bodies/placement.hpp"
#include "grid/voxels.hpp"

#include <cstdint>
#include <map>
#include <vector>

namespace eulastic {

/// Two bodies, by their labels: 1, 2, ... through all species, a body from a file being one.
struct Overlap {
  int body = 0, other = 0;  ///< body < other; 0 = none
  double volume = 0;        ///< that they share, at least: the sum of what is above 1 in a cell; area in 2-D
};

/// Whether each body of `own` (label - 1) overlaps any other: in some cell their solid fractions add up to more than
/// 1.01, which bodies that touch do not. `first`: the first pair with one of them. No pairs of: two attached bodies,
/// which is how walls are joined; bodies of one species with -NAME_contact merge, which are one; a body at random and
/// one before it; bodies from files (add_shared). Communicates nothing; memory for bodies of `own` only.
std::vector<char> find_overlaps(const std::vector<SpeciesSpec> &species,
                                const std::vector<std::vector<BodyPlace>> &places, const GridSpec &grid,
                                const BodyRange &own, Overlap *first);

/// What a body shares with a solid: volume in 2^-30 cells, to be added without round-off, and whether they overlap.
struct SharedVolume {
  std::int64_t volume = 0;
  bool overlaps = false;
};

/// Adds what bodies of a species share with the solid of `fraction` in layers of the box, by their index in `places`.
void add_shared(const SpeciesSpec &spec, const std::vector<BodyPlace> &places, const GridSpec &grid,
                const CellWindow &layers, ConstView fraction, std::map<int, SharedVolume> *shared);

}  // namespace eulastic
