// Where the bodies of a species are: one, a list from a file, or a lattice (at random: bodies/seeding.hpp).
#pragma once

#include "base/body_range.hpp"
#include "bodies/species.hpp"

#include <initializer_list>
#include <vector>

namespace eulastic {

/// Of a lattice, or at random: those at random are all on every rank while they are placed.
inline constexpr int most_bodies = 10000000;

struct BodyPlace {
  Real3 centre{};       ///< in the box; z is the middle in 2-D
  Real3 orientation{};  ///< degrees about x, then y, then z
};

struct NumberedPlace : BodyPlace {
  int index = 0;  ///< of the body in its species
};

/// The bodies of a species: how many there are, and where those are that a rank knows of.
struct Places {
  Places() = default;
  Places(const std::vector<BodyPlace> &all);  ///< known everywhere
  Places(std::initializer_list<BodyPlace> all) : Places(std::vector<BodyPlace>(all)) {}

  int count = 0;
  bool everywhere = true;            ///< every rank knows all of them; else each is known to at least one
  std::vector<NumberedPlace> known;  ///< in the order of the bodies
  /// Forgets all but those that a rank has of them (BodyRange).
  void share_among(int rank, int ranks);
};

/// Which bodies are kept: those that a rank has of all; if nothing is said, all.
struct KeptBodies {
  int rank = 0, ranks = 1;
};

/// Finds all bodies of a species, one after the other, and keeps some in `places`. Returns an empty string, or
/// one sentence on what is wrong: an impossible shape, a bad line of the file, a body outside the box, longer than it,
/// or reaching into a wall (slabs, cylinders and tubes may), a lumen that leaves the box. List: rows of x,y,z or
/// x,y,z,angle_x,angle_y,angle_z (base/number_rows.hpp), the number of rows first or not; angles of a row replace the
/// species' orientation. Lattice: centres at (i + 1/2) L/n, and jitter. A slab lies where its interval says; shapes
/// from files place nothing. Collective over all ranks of the program where there is a list, which rank 0 reads.
std::string place_bodies(const SpeciesSpec &spec, const DomainShape &grid, Places *places, const KeptBodies &kept = {});

}  // namespace eulastic
