// A species: bodies of one shape and one material, and how they are placed.
#pragma once

#include "field/material.hpp"
#include "field/rigid_faces.hpp"
#include "grid/box.hpp"

#include <array>
#include <limits>
#include <optional>
#include <string>

namespace eulastic {

enum class Shape { sphere, biconcave, ellipsoid, cylinder, slab, tube, constricted_tube, voxels, state };
// voxels: from a file; state: from -initial_state

/// Whether a shape is a vessel wall: infinite and anchored to the boundaries.
constexpr bool is_tube(Shape shape) { return shape == Shape::tube || shape == Shape::constricted_tube; }
/// Whether bodies of a shape are anchored unless -NAME_anchored says otherwise.
constexpr bool is_anchored(Shape shape) { return shape == Shape::slab || is_tube(shape); }
/// Whether bodies of a shape come from a file.
constexpr bool is_from_file(Shape shape) { return shape == Shape::voxels || shape == Shape::state; }
/// Whether a shape is finite and given by its sizes.
constexpr bool is_closed(Shape shape) {
  return shape == Shape::sphere || shape == Shape::biconcave || shape == Shape::ellipsoid;
}
enum class Placement { one, list, lattice, random };
/// Storage of the bodies of a species: each in a box of its own, so that they never merge, or all in one phase of the
/// grid.
enum class Contact { separate, merge };

/// One body from a file: voxels or a closed surface.
struct VoxelSpec {
  static constexpr double not_given = std::numeric_limits<double>::quiet_NaN();
  std::string path;                                ///< FILE or FILE:DATASET
  Real3 spacing{not_given, not_given, not_given};  ///< size of a voxel; unit of length of a surface
  Real3 origin{not_given, not_given, not_given};   ///< low corner of the first voxel; position of a surface's (0,0,0)
  bool invert = false;                             ///< the outside of the surface is solid
};

struct SpeciesSpec {
  std::string name;
  Shape shape = Shape::sphere;
  double radius = 0;                 ///< sphere, cylinder, biconcave (half the diameter); lumen of tubes
  double throat_radius = 0;          ///< constricted_tube: narrowest radius of the lumen, at the centre
  double throat_length = 0;          ///< length over which the lumen is narrower than `radius`
  Real3 semi_axes{};                 ///< ellipsoid
  int axis = 1;                      ///< symmetry axis of biconcave, cylinder, tubes; normal of slab: 0, 1, 2
  std::array<double, 2> interval{};  ///< slab
  VoxelSpec voxels;
  Law law = Law::neo_hookean;
  double shear_modulus = 0;         ///< neo-Hookean; pressure units
  double c1 = 0, c2 = 0, c3 = 0;    ///< Mooney-Rivlin; pressure units
  std::optional<double> viscosity;  ///< dynamic; default: the fluid's
  double surface_tension = 0;       ///< force per length
  BodyForce body_force{};           ///< on these bodies only
  Membrane membrane{};              ///< Law::membrane
  StretchForce stretch_force{};     ///< Law::membrane
  RigidMotion motion;               ///< Law::rigid
  std::optional<bool> anchored;     ///< default by shape: is_anchored()
  std::optional<Contact> contact;   ///< default: Config::boxes()
  Real3 initial_stretch{1, 1,
                        1};  ///< l in B = diag(l^2), rotated with the body; the shape is that of the stretched state
  Placement placement = Placement::one;
  Real3 centre{};
  bool centre_given = false;  ///< otherwise the centre of the domain
  std::string positions_file;
  Int3 count{1, 1, 1};     ///< lattice
  double jitter = 0;       ///< lattice: largest displacement, as a fraction of the free distance to neighbours
  long number = -1;        ///< random: number of bodies, or -1 if the hematocrit is given
  double hematocrit = -1;  ///< random: volume fraction of bodies in their region
  std::string inside;      ///< random: name of the tube; empty: the only tube, or none
  double gap = 0;          ///< random: least distance between bodies, half of it to walls
  long seed = 1;
  Real3 orientation{};  ///< Euler angles in degrees: rotations about x, then y, then z
  bool random_orientation = false;

  /// Whether it is a vessel or an obstacle, on whose surface the stress of the fluid is measured.
  bool bears_load() const {
    return law == Law::rigid || (!is_membrane() && (anchored.value_or(is_anchored(shape)) || shape == Shape::voxels));
  }
  /// Directions in which a rigid body moves relative to the grid; in the others it rests or slides along itself.
  std::array<bool, 3> travelling(int dimension) const {
    std::array<bool, 3> found{};
    for (int d = 0; law == Law::rigid && d < dimension; ++d) found[d] = motion.velocity[d] != 0 && !slides(d);
    return found;
  }
  /// Whether a rigid body rotates and its shape is not invariant under that rotation.
  bool turns(int dimension) const {
    const Real3 &w = motion.angular_velocity;
    const bool flat = dimension == 2, about_axis = w[(axis + 1) % 3] == 0 && w[(axis + 2) % 3] == 0;
    const bool round = shape == Shape::sphere || ((shape == Shape::cylinder || is_tube(shape)) && about_axis);
    return law == Law::rigid && !round && (flat ? w[2] != 0 : w != Real3{});
  }
  bool travels(int dimension) const { return turns(dimension) || travelling(dimension) != std::array<bool, 3>{}; }
  /// Whether the shape is invariant under a shift along d.
  bool slides(int d) const {
    if (shape == Shape::slab) return d != axis;
    return (shape == Shape::tube || shape == Shape::cylinder) && d == axis;
  }
  bool is_membrane() const { return law == Law::membrane || law == Law::red_cell; }
  Material material() const;
};

}  // namespace eulastic
