// Shapes in body coordinates: implicit functions, sizes, volumes, and rotations.
//
// Sphere, ellipsoid, cylinder and slab are one quadric with none, none, one or two infinite axes. Biconcave: the red
// cell of Evans & Fung (1972), thickness h(r) = R sqrt(1-q) (c0 + c1 q + c2 q^2), q = (r/R)^2. Tubes: all outside of a
// lumen of radius R, constricted R - (R - R_throat) (1 + cos(2 pi s/L_throat))/2 at |s| < L_throat/2 along the axis.
#pragma once

#include "bodies/level_map.hpp"
#include "bodies/species.hpp"

#include <memory>

namespace eulastic {

/// Thickness of a biconcave body on its axis, in radii.
inline constexpr double red_cell_waist = 0.207161;
/// Rows of R: box coordinates = R body coordinates.
using Rotation = std::array<Real3, 3>;
/// Rotation about x, then y, then z by angles in degrees; multiples of 90 are exact.
Rotation rotation(const Real3 &degrees);
/// The angles of an orientation that is turned further about the direction of `angle`, by its length in rad.
Real3 turned(const Real3 &degrees, const Real3 &angle);

/// The surface of one shape in body coordinates, centred at 0. In 2-D nothing depends on z.
class Surface {
public:
  Surface(const SpeciesSpec &spec, int dimension);
  explicit Surface(LevelMap map);

  /// Negative inside, positive outside; smooth near the surface. Not a distance: see slope().
  double level(const Real3 &y) const noexcept;
  /// Upper bound of |grad level| within `reach` of y.
  double slope(const Real3 &y, double reach) const noexcept;
  /// Largest n.y over the body, |n| = 1; infinite where the body is. At most 3e-6 radii too large.
  double support(const Real3 &n) const;
  /// Radius of a sphere around the body, infinite for cylinder, slab and tubes.
  double bounding_radius() const;
  /// Memory, of what is more than a few numbers.
  std::size_t bytes() const { return map_ ? map_->bytes() : 0; }

private:
  Shape shape_;
  int axis_;
  double radius_;                  ///< biconcave: half the diameter; tubes: of the lumen; else the shortest semi-axis
  Real3 inverse_;                  ///< 1 / semi-axes, 0 for an infinite one; tubes: 1 across, 0 along
  double depth_ = 0, throat_ = 1;  ///< constriction: R - R_throat, its length
  std::shared_ptr<const LevelMap> map_;  ///< of a file, else null
};

/// Radius of the lumen of a tube at distance s from its centre along the axis.
double lumen_radius(const SpeciesSpec &spec, double s);
/// Analytic volume (area in 2-D); of a cylinder per length of its axis, of a slab per area (2-D: per length), of tubes
/// 0.
double shape_volume(const SpeciesSpec &spec, int dimension);
/// Of the part inside the box: of one body, of all of a slab or tube (area in 2-D).
double volume_in_box(const SpeciesSpec &spec, const DomainShape &grid);
/// Inside a tube, between the sides of the box (area in 2-D).
double lumen_volume(const SpeciesSpec &spec, const DomainShape &grid);
/// Pressure drop along a tube from side to side of the box, per flow rate and viscosity, by Poiseuille's law in every
/// section: 8/pi times the integral of R^-4; in 2-D, a channel, 3/2 times that of R^-3, per depth.
double lumen_resistance(const SpeciesSpec &spec, const DomainShape &grid);
/// Empty, or one sentence on why the sizes of this shape make no body in `dimension` dimensions.
std::string why_no_shape(const SpeciesSpec &spec, int dimension);

}  // namespace eulastic
