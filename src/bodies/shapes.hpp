// Shapes in body coordinates: implicit functions, sizes, volumes, and rotations.
//
// Sphere, ellipsoid, cylinder and slab are one quadric with none, none, one or two infinite axes. Biconcave: the red
// cell of Evans & Fung (1972), thickness h(r) = R sqrt(1-q) (c0 + c1 q + c2 q^2), q = (r/R)^2.
#pragma once

#include "bodies/species.hpp"

namespace eulastic {

/// Rows of R: box coordinates = R body coordinates.
using Rotation = std::array<Real3, 3>;
/// Rotation about x, then y, then z by angles in degrees; multiples of 90 are exact.
Rotation rotation(const Real3 &degrees);

/// The surface of one shape in body coordinates, centred at 0. In 2-D nothing depends on z.
class Surface {
public:
  Surface(const SpeciesSpec &spec, int dimension);

  /// Negative inside, positive outside; smooth near the surface. Not a distance: see slope().
  double level(const Real3 &y) const noexcept;
  /// Upper bound of |grad level| within `reach` of y.
  double slope(const Real3 &y, double reach) const noexcept;
  /// Largest n.y over the body, |n| = 1; infinite where the body is. At most 3e-6 radii too large.
  double support(const Real3 &n) const;
  /// Radius of a sphere around the body, infinite for cylinder and slab.
  double bounding_radius() const;

private:
  bool biconcave_;
  int axis_;
  double radius_;  ///< biconcave: half the diameter; else the shortest semi-axis
  Real3 inverse_;  ///< 1 / semi-axes, 0 for an infinite one
};

/// Analytic volume (area in 2-D); of a cylinder per length of its axis, of a slab per area (2-D: per length).
double shape_volume(const SpeciesSpec &spec, int dimension);
/// Empty, or one sentence on why the sizes of this shape make no body in `dimension` dimensions.
std::string why_no_shape(const SpeciesSpec &spec, int dimension);

}  // namespace eulastic
