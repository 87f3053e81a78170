// The shape of a body given by its solid fraction on a grid, for instance from a file: a level-set function on that
// grid, zero on the surface, with which the body can be rotated and moved.
#pragma once

#include "grid/box.hpp"

#include <vector>

namespace eulastic {

/// Solid fraction in a box of cells around a body.
struct FractionBox {
  Int3 size{};                   ///< cells
  Real3 spacing{}, first{};      ///< `first`: centre of the first cell relative to the centre of the body
  std::vector<double> fraction;  ///< x fastest; zero within LevelMap::margin cells of the ends
};

/// The level is the quantile of the filtered fraction (docs/method.md, section 18, "Surface cells"): nearly linear in
/// the distance near the surface and constant further away. Parts thinner than three cells are not represented
/// correctly.
class LevelMap {
public:
  static constexpr int margin = 5;  ///< cells
  LevelMap(const FractionBox &box, int dimension);

  /// Returns the level at a position relative to the centre of the body, negative inside, by trilinear interpolation.
  double level(const Real3 &y) const noexcept;
  /// Returns an upper bound of |grad level|.
  double slope() const noexcept { return slope_; }
  /// Upper bounds of |n.y|, |n| = 1, and of |y| over the body.
  double support(const Real3 &n) const noexcept;
  double bounding_radius() const noexcept { return radius_; }
  std::size_t bytes() const { return (level_.capacity() + 3 * edge_.capacity()) * sizeof(double); }

private:
  int dimension_;
  Int3 size_;
  Real3 spacing_, first_;
  std::vector<double> level_;
  std::vector<Real3> edge_;  ///< grid points inside with a neighbour outside
  double slope_ = 0, radius_ = 0;
};

}  // namespace eulastic
