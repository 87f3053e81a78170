// Shapes in body coordinates: implicit functions, sizes, volumes, and rotations.
//
// Sphere and ellipsoid are quadrics, cylinder and slab the same with one or two infinite axes. Biconcave: the red cell
// of Evans and Fung (1972), thickness h(r) = R sqrt(1-q) (c0 + c1 q + c2 q^2), q = (r/R)^2. Tubes: the outside of a
// lumen of radius R, constricted to R - (R - R_throat) (1 + cos(2 pi s/L_throat))/2 at |s| < L_throat/2 along the axis.
#pragma once

#include "bodies/level_map.hpp"
#include "bodies/species.hpp"

#include <memory>

namespace eulastic {

/// Thickness of a biconcave body on its axis, in radii.
inline constexpr double red_cell_waist = 0.207161;
/// Rows of the rotation matrix R: domain coordinates = R body coordinates.
using Rotation = std::array<Real3, 3>;
/// Returns the rotation about x, then y, then z by angles in degrees; multiples of 90 are exact.
Rotation rotation(const Real3 &degrees);
/// Returns the orientation, in degrees, after a further rotation about the direction of `angle` by its length in rad.
Real3 turned(const Real3 &degrees, const Real3 &angle);

/// The surface of one shape in body coordinates, centred at 0. In 2-D nothing depends on z.
class Surface {
public:
  Surface(const SpeciesSpec &spec, int dimension);
  explicit Surface(LevelMap map);

  /// Returns a level-set function, negative inside and smooth near the surface. It is not a distance: see slope().
  double level(const Real3 &y) const noexcept;
  /// Returns an upper bound of |grad level| within `reach` of y.
  double slope(const Real3 &y, double reach) const noexcept;
  /// Support function: the largest n.y over the body, |n| = 1; infinite for infinite bodies. At most 3e-6 radii too
  /// large.
  double support(const Real3 &n) const;
  /// Radius of a circumscribed sphere; infinite for cylinder, slab and tubes.
  double bounding_radius() const;
  /// Bytes of the level map, if there is one.
  std::size_t bytes() const { return map_ ? map_->bytes() : 0; }

private:
  Shape shape_;
  int axis_;
  double radius_;                  ///< biconcave: half the diameter; tubes: lumen; otherwise the shortest semi-axis
  Real3 inverse_;                  ///< 1 / semi-axes, 0 for an infinite one; tubes: 1 across, 0 along
  double depth_ = 0, throat_ = 1;  ///< constriction: R - R_throat, its length
  std::shared_ptr<const LevelMap> map_;  ///< for shapes from files, otherwise null
};

/// Returns the lumen's radius of a tube at distance s from its centre along the axis.
double lumen_radius(const SpeciesSpec &spec, double s);
/// Returns the analytic volume (area in 2-D): of a cylinder per length, of a slab per area (2-D: per length), of tubes
/// 0.
double shape_volume(const SpeciesSpec &spec, int dimension);
/// Returns the volume (area in 2-D) inside the domain of one body, slab or tube wall.
double volume_in_box(const SpeciesSpec &spec, const DomainShape &grid);
/// Returns the volume of a tube's lumen inside the domain (area in 2-D).
double lumen_volume(const SpeciesSpec &spec, const DomainShape &grid);
/// Returns the pressure drop along a tube through the domain, per flow rate and viscosity, by Poiseuille's law in every
/// cross section: 8/pi times the integral of R^-4; in 2-D, for a channel, 3/2 times that of R^-3 per depth.
double lumen_resistance(const SpeciesSpec &spec, const DomainShape &grid);

}  // namespace eulastic
