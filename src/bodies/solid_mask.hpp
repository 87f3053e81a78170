// The cells that a body from a file takes, all of the box at once: bodies at random keep out of them.
#pragma once

#include "bodies/convex.hpp"
#include "grid/voxels.hpp"

#include <array>
#include <cstdint>
#include <vector>

namespace eulastic {

class SolidMask {
public:
  /// One bit per cell, none set.
  explicit SolidMask(const DomainShape &grid);

  /// Sets those of `window` where `fraction` is not 0.
  void add(const CellWindow &window, ConstView fraction);
  bool has(const Int3 &cell) const { return bits_[word(cell[0], cell[1], cell[2])] >> (cell[0] % 64) & 1; }
  /// Whether any of the cells that are set touches `body`, whose centre is in the box. If not, no cell holds a part of
  /// both.
  bool touches(const PlacedConvex &body) const;

private:
  std::size_t word(int i, int j, int k) const { return (std::size_t(k) * grid_.cells[1] + j) * words_ + i / 64; }
  bool row_touches(const PlacedConvex &body, int j, int k, const Real3 &centre, int begin, int end) const;

  DomainShape grid_;
  int dimension_;
  std::size_t words_;  // of a row
  Real3 spacing_{};
  std::vector<std::uint64_t> bits_;
  ConvexBody cell_;
};

/// All bodies from files, and what stays free of bodies beside the sides of the box.
struct SolidBodies {
  double volume = 0;  ///< in the box; area in 2-D
  std::vector<SolidMask> masks;
  std::array<std::array<double, 2>, 3> free{};  ///< [direction][low, high]: widths
};

}  // namespace eulastic
