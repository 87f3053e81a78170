// Convex bodies around shapes, for placement without overlap.
//
// A body is a core (point, disc, ellipsoid, segment or box) and all points within `rounding` of it. A sphere is exact;
// a red cell lies in a rounded disc, 14 % larger; an ellipsoid with semi-axes a in the ellipsoid a - r rounded
// by r, which is half a per cent wider for a platelet.
#pragma once

#include "bodies/shapes.hpp"

namespace eulastic {

class ConvexBody {
public:
  /// Encloses a shape; `margin` is added all around. A cylinder ends at `length` from its centre.
  ConvexBody(const SpeciesSpec &spec, int dimension, double margin, double length = 0);
  /// A grid cell with sharp edges, by half its sides; in 2-D half_sides[2] is 0.
  explicit ConvexBody(const Real3 &half_sides);

  /// Returns the body with all lengths multiplied by `factor`.
  ConvexBody scaled(double factor) const;

  /// Returns the farthest point of the core in direction n, in body coordinates.
  Real3 core(const Real3 &n) const noexcept;
  double rounding() const { return rounding_; }
  double outer_radius() const { return outer_; }  ///< radius of a circumscribed sphere
  double inner_radius() const { return inner_; }  ///< radius of an inscribed sphere
  /// Whether the projection along body axis d is an ellipse.
  bool has_round_shadow(int d) const { return kind_ != Kind::disc || d == axis_; }

private:
  enum class Kind { ellipsoid, disc, segment, box } kind_;
  int axis_ = 0;
  Real3 size_{};  ///< semi-axes of the core; half the sides; radius of the disc and half the segment in [0]
  double rounding_, outer_, inner_;
};

struct PlacedConvex {
  const ConvexBody *body;
  Real3 centre;
  Rotation rotation;

  /// Half the width along coordinate d.
  double half_width(int d) const noexcept;
  /// Support function: the largest n.(x - centre), |n| = 1.
  double support(const Real3 &n) const noexcept;
};

/// Returns whether a, and b moved by `shift`, do not touch. Bodies that are within round-off of touching count as
/// touching.
bool separated(const PlacedConvex &a, const PlacedConvex &b, const Real3 &shift) noexcept;

/// Overlap of two bodies; its depth is at most the sum of their roundings, even if their cores intersect.
struct Penetration {
  double depth = 0;  ///< 0 if they do not touch
  Real3 normal{};    ///< unit vector from a to b
  Real3 point{};     ///< middle of the overlap, relative to the centre of a
  int other = -1;    ///< index of b in a crowd
};
/// Returns the overlap of a, and b moved by `shift`. For flat bodies side by side it is more accurate than separated();
/// it is slower.
Penetration penetration(const PlacedConvex &a, const PlacedConvex &b, const Real3 &shift) noexcept;

}  // namespace eulastic
