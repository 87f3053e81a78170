// Placement of the bodies of a species: one body, a list from a file, or a lattice (random: bodies/seeding.hpp).
#pragma once

#include "base/body_range.hpp"
#include "bodies/species.hpp"

#include <initializer_list>
#include <vector>

namespace eulastic {

/// Largest number of bodies of a species. Every rank holds all bodies while they are placed at random.
inline constexpr int most_bodies = 10000000;

struct BodyPlace {
  Real3 centre{};       ///< in the domain; z is its middle in 2-D
  Real3 orientation{};  ///< degrees about x, then y, then z
};

struct NumberedPlace : BodyPlace {
  int index = 0;  ///< number of the body in its species, from 0
};

/// The bodies of a species: their number, and the places of those that this rank knows.
struct Places {
  Places() = default;
  Places(const std::vector<BodyPlace> &all);  ///< known everywhere
  Places(std::initializer_list<BodyPlace> all) : Places(std::vector<BodyPlace>(all)) {}

  int count = 0;
  bool everywhere = true;            ///< every rank knows all; otherwise at least one rank knows each
  std::vector<NumberedPlace> known;  ///< in the order of the bodies
  /// Keeps only the bodies in the rank's BodyRange.
  void share_among(int rank, int ranks);
};

/// The bodies that a rank stores: its BodyRange of `ranks`; by default all.
struct KeptBodies {
  int rank = 0, ranks = 1;
};

/// Finds the bodies of a species in order and stores in `places` those that `kept` selects. Returns an empty string, or
/// an error of one line that names the option: an invalid line of the file, a body that is outside the domain, longer
/// than it or reaches into a wall (slabs, cylinders and tubes may), or a lumen that leaves the domain. A list has rows
/// x,y,z or x,y,z,angle_x,angle_y,angle_z (base/number_rows.hpp), optionally preceded by their number; the angles of a
/// row replace the species' orientation. A lattice has its centres at (i + 1/2) L/n plus jitter. A slab fills its
/// interval; shapes from files place nothing. With a list, which rank 0 reads, it is collective over all ranks.
std::string place_bodies(const SpeciesSpec &spec, const DomainShape &grid, Places *places, const KeptBodies &kept = {});

}  // namespace eulastic
