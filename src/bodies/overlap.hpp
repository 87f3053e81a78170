// Detection of bodies that are placed over each other.
#pragma once

#include "bodies/placement.hpp"
#include "grid/voxels.hpp"

#include <cstdint>
#include <map>
#include <vector>

namespace eulastic {

/// Two overlapping bodies by their labels, which run 1, 2, ... through all species; a body from a file counts as one.
struct Overlap {
  int body = 0, other = 0;  ///< body < other; 0: none
  double volume = 0;        ///< lower bound of the shared volume: sum of the fractions' excess over 1; area in 2-D
  bool same_place = false;  ///< both, or periodic images, coincide, so that one of them has no cells
};

/// Returns the first label of every species, and the end of all labels.
std::vector<int> first_labels(const std::vector<SpeciesSpec> &species, const std::vector<Places> &places);

/// Returns whether there are any pairs to compare.
bool may_overlap(const std::vector<SpeciesSpec> &species, const std::vector<Places> &places);

/// Returns the labels, ascending, of the known bodies that overlap another one: in some cell their solid fractions add
/// up to more than 1.01, which those of touching bodies do not. `first`: the first pair at the same place, otherwise
/// the first pair. Not compared are two anchored bodies (walls are joined so), bodies of one species with -NAME_contact
/// merge, randomly placed bodies with earlier ones, and bodies from files (add_shared). If every rank knows the bodies
/// near its cells (send_to_near_ranks), all ranks together find every pair.
std::vector<int> find_overlaps(const std::vector<SpeciesSpec> &species, const std::vector<Places> &places,
                               const DomainShape &grid, Overlap *first);

/// Volume shared by a body and a solid, in units of 2^-30 cells so that sums are exact, and whether they overlap.
struct SharedVolume {
  std::int64_t volume = 0;
  bool overlaps = false;
};

/// Adds to `shared`, by body index, what the known bodies of a species share with the solid of `fraction` in `cells`.
void add_shared(const SpeciesSpec &spec, const Places &places, const DomainShape &grid, const CellWindow &cells,
                ConstView fraction, std::map<int, SharedVolume> *shared);

}  // namespace eulastic
