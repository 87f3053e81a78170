// Bodies that are placed over each other.
#pragma once

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
  bool same_place =
      false;  ///< one of them, or an image of it, is where the other one is, so that one has no cells left
};

/// The first label of every species, and one more.
std::vector<int> first_labels(const std::vector<SpeciesSpec> &species, const std::vector<Places> &places);

/// Whether there are any pairs to look at.
bool may_overlap(const std::vector<SpeciesSpec> &species, const std::vector<Places> &places);

/// Labels, ascending, of the known bodies that overlap another one: in some cell their solid fractions add up to more
/// than 1.01, which bodies that touch do not. `first`: the first pair at the same place, or else of them all. No pairs
/// of: two attached bodies, which is how walls are joined; bodies of one species with -NAME_contact merge, which are
/// one; a body at random and one before it; bodies from files (add_shared). Where ranks know what comes near their
/// boxes (bring_near), together they find all.
std::vector<int> find_overlaps(const std::vector<SpeciesSpec> &species, const std::vector<Places> &places,
                               const DomainShape &grid, Overlap *first);

/// What a body shares with a solid: volume in 2^-30 cells, to be added without round-off, and whether they overlap.
struct SharedVolume {
  std::int64_t volume = 0;
  bool overlaps = false;
};

/// Adds what the known bodies of a species share with the solid of `fraction` in some cells of the box, by their index.
void add_shared(const SpeciesSpec &spec, const Places &places, const DomainShape &grid, const CellWindow &cells,
                ConstView fraction, std::map<int, SharedVolume> *shared);

}  // namespace eulastic
