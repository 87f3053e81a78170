// Convex bodies around shapes, for placement without overlap.
//
// A core (point, disc, ellipsoid, segment or box) and all within `rounding` of it: a sphere is its own; the red cell is
// in a rounded disc, 14 % larger; the ellipsoid a in the ellipsoid a - r rounded by r, half a per cent wider for a
// platelet.
#pragma once

#include "bodies/shapes.hpp"

namespace eulastic {

class ConvexBody {
public:
  /// `margin` is added all around. A cylinder is cut at `length` from its centre.
  ConvexBody(const SpeciesSpec &spec, int dimension, double margin, double length = 0);
  /// A cell of the grid, sharp; half its sides, in 2-D 0 along z.
  explicit ConvexBody(const Real3 &half_sides);

  /// The same body, all its lengths times `factor`.
  ConvexBody scaled(double factor) const;

  /// Farthest point of the core in direction n, in body coordinates.
  Real3 core(const Real3 &n) const noexcept;
  double rounding() const { return rounding_; }
  double outer_radius() const { return outer_; }  ///< of a sphere around it
  double inner_radius() const { return inner_; }  ///< of a sphere inside it
  /// Whether its shadow along body axis d is an ellipse.
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

  /// Half its width along coordinate d.
  double half_width(int d) const noexcept;
  /// Largest n.(x - centre), |n| = 1.
  double support(const Real3 &n) const noexcept;
};

/// Whether a and b, moved by `shift`, do not touch. Round-off and very close bodies count as touching.
bool separated(const PlacedConvex &a, const PlacedConvex &b, const Real3 &shift) noexcept;

/// How deep two bodies overlap: at most the sum of their roundings, also where their cores meet.
struct Penetration {
  double depth = 0;  ///< 0: they do not touch
  Real3 normal{};    ///< from a to b, of length 1
  Real3 point{};     ///< in the middle of the overlap, from the centre of a
  int other = -1;    ///< b, in a crowd
};
/// Of a and b, moved by `shift`: more exact than separated() where they are flat and side by side, and slower.
Penetration penetration(const PlacedConvex &a, const PlacedConvex &b, const Real3 &shift) noexcept;

}  // namespace eulastic
