// The cells of the whole domain that a body from a file occupies, for the random placement of others outside of it.
#pragma once

#include "bodies/convex.hpp"
#include "grid/voxels.hpp"

#include <array>
#include <cstdint>
#include <vector>

namespace eulastic {

class SolidMask {
public:
  /// Allocates one bit per cell, all 0.
  explicit SolidMask(const DomainShape &grid);

  /// Sets the bits of the cells of `window` in which `fraction` is not 0.
  void add(const CellWindow &window, ConstView fraction);
  /// Returns whether a cell is marked.
  bool has(const Int3 &cell) const { return bits_[word(cell[0], cell[1], cell[2])] >> (cell[0] % 64) & 1; }
  /// Returns whether any marked cell touches `body`, whose centre is in the domain. If not, no cell contains parts of
  /// both.
  bool touches(const PlacedConvex &body) const;

private:
  std::size_t word(int i, int j, int k) const { return (std::size_t(k) * grid_.cells[1] + j) * words_ + i / 64; }
  bool row_touches(const PlacedConvex &body, int j, int k, const Real3 &centre, int begin, int end) const;

  DomainShape grid_;
  int dimension_;
  std::size_t words_;  // 64-bit words per row
  Real3 spacing_{};
  std::vector<std::uint64_t> bits_;
  ConvexBody cell_;
};

/// All bodies from files, and the strips beside the boundaries that stay free of bodies.
struct SolidBodies {
  double volume = 0;  ///< inside the domain; area in 2-D
  std::vector<SolidMask> masks;
  std::array<std::array<double, 2>, 3> free{};  ///< [direction][low, high]: widths
};

}  // namespace eulastic
