// Which pieces of ghost rows, and which row ends, are near what a field holds: of other fields of the same bodies no
// more has to be exchanged.
#pragma once

#include "base/petsc.hpp"
#include "grid/box.hpp"

#include <cstdint>
#include <map>
#include <utility>
#include <vector>

namespace eulastic {

class OccupiedRows;

class GhostPieces {
public:
  static constexpr int cells = 8;  ///< of a piece: 64 bytes, as rows are aligned

  /// Whether there are ghosts that are not behind walls, and pieces of rows that all ranks cut alike.
  static bool exist(const Box &box);
  /// Those within `reach` cells in every direction of values that are not zero, the ghosts that there are included.
  /// `rows` of `value`.
  GhostPieces(const Box &box, ConstView value, const OccupiedRows &rows, int reach);

  /// Piece m has the cells 8 m ... of a row.
  int count() const noexcept { return count_; }
  bool holds(int j, int k, int m) const noexcept { return words_[word(j, k, m)] >> (m % bits) & 1; }
  /// Whether a row has them where x wraps around.
  bool holds_ends(int j, int k) const noexcept { return holds(j, k, 0) || holds(j, k, count_ - 1); }
  /// Whether all pieces of another one are here, too.
  bool hold(const GhostPieces &other) const noexcept;

  /// Of GhostExchange, by width and number of fields.
  mutable std::map<std::pair<int, int>, SfHandle> scatters;

private:
  static constexpr int bits = 64;
  std::size_t word(int j, int k, int m) const noexcept {
    return (j + ghosts_[1] + static_cast<std::size_t>(rows_y_) * (k + ghosts_[2])) * per_row_ + m / bits;
  }
  Int3 ghosts_{};
  int count_ = 0, per_row_ = 0, rows_y_ = 0, rows_z_ = 0;
  std::vector<std::uint64_t> words_;  ///< a bit for each piece; of owned rows only for their ends
};

}  // namespace eulastic
