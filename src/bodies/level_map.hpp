// The shape of a body that is known by its solid fraction in the cells of a grid, as one from a file is: a level that
// is 0 on its surface, on that lattice, so that it can be turned and moved.
#pragma once

#include "grid/box.hpp"

#include <vector>

namespace eulastic {

/// Solid fraction in a box of cells around a body.
struct FractionBox {
  Int3 size{};                   ///< cells
  Real3 spacing{}, first{};      ///< `first`: the middle of the first cell, from the centre of the body
  std::vector<double> fraction;  ///< x fastest; nothing solid within LevelMap::margin of the ends
};

/// The level is the quantile of the fraction, averaged as in docs/method.md, section 18, "Surface cells": nearly linear
/// in the distance near the surface, constant further away. What is thinner than three cells is not seen rightly.
class LevelMap {
public:
  static constexpr int margin = 5;  ///< cells
  LevelMap(const FractionBox &box, int dimension);

  /// Negative inside, at a place from the centre of the body; trilinear.
  double level(const Real3 &y) const noexcept;
  /// Upper bound of |grad level|.
  double slope() const noexcept { return slope_; }
  /// Upper bounds of |n.y| over the body, |n| = 1, and of |y|.
  double support(const Real3 &n) const noexcept;
  double bounding_radius() const noexcept { return radius_; }
  std::size_t bytes() const { return (level_.capacity() + 3 * edge_.capacity()) * sizeof(double); }

private:
  int dimension_;
  Int3 size_;
  Real3 spacing_, first_;
  std::vector<double> level_;
  std::vector<Real3> edge_;  ///< points of the lattice inside with one outside beside them
  double slope_ = 0, radius_ = 0;
};

}  // namespace eulastic
