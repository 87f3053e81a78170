// A species: bodies of one shape and one material, and where they are placed.
#pragma once

#include "grid/grid.hpp"

#include <array>
#include <string>

namespace eulastic {

enum class Shape { sphere, biconcave, ellipsoid, cylinder, slab, state };  // state: from -initial_state
enum class Placement { one, list, lattice };

struct SpeciesSpec {
  std::string name;
  Shape shape = Shape::sphere;
  double radius = 0;                 ///< sphere, biconcave (half the diameter), cylinder
  Real3 semi_axes{};                 ///< ellipsoid
  int axis = 1;                      ///< symmetry axis of biconcave, cylinder; normal of slab: 0, 1, 2
  std::array<double, 2> interval{};  ///< slab
  double shear_modulus = 0;          ///< pressure units
  Real3 initial_stretch{1, 1, 1};    ///< along x, y, z: B = diag(l^2); the shape is given in the stretched state
  Placement placement = Placement::one;
  Real3 centre{};
  bool centre_given = false;  ///< default: box centre
  std::string positions_file;
  Int3 count{1, 1, 1};  ///< lattice
  Real3 orientation{};  ///< Euler angles in degrees: rotations about x, then y, then z
};

}  // namespace eulastic
