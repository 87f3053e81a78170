// Where the bodies of a species are: one, a list from a file, or a lattice (at random: bodies/seeding.hpp).
#pragma once

#include "bodies/species.hpp"

#include <vector>

namespace eulastic {

/// Every rank keeps a list of all bodies and sums over them.
inline constexpr int most_bodies = 10000000;

struct BodyPlace {
  Real3 centre{};       ///< in the box; z is the middle in 2-D
  Real3 orientation{};  ///< degrees about x, then y, then z
};

/// Fills `places` in the order of the labels. Returns an empty string, or one sentence on what is wrong: an
/// impossible shape, a bad line of the file, a body outside the box, longer than it, or reaching into a wall (slabs,
/// cylinders and tubes may), a lumen that leaves the box. List: CSV with x,y,z or x,y,z,angle_x,angle_y,angle_z per
/// line, such a header line and empty lines allowed; angles on a line replace the species' orientation. Lattice:
/// centres at (i + 1/2) L/n, and jitter. A slab lies where its interval says; shape state places nothing. Collective
/// over all ranks of the program where there is a list.
std::string place_bodies(const SpeciesSpec &spec, const GridSpec &grid, std::vector<BodyPlace> *places);

}  // namespace eulastic
