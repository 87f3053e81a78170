// Which rows of a field hold anything but zeros: what there is to do in the others is known without reading them.
#pragma once

#include "grid/grid.hpp"

#include <algorithm>

namespace eulastic {

class OccupiedRows {
public:
  /// Reads all of `value`, ghosts included. Before that every row counts as occupied.
  void find(const Grid &grid, ConstView value);
  /// The same after a transport by less than a reach: what was idle is still empty and is not read.
  void follow(const Grid &grid, ConstView value);
  /// Whether row (j, k) and all rows that stencils join to it in y and z are zero, ghosts in x included: as many as
  /// there are ghosts, one as edges belong to the centres below them too, one for what moves within a step. Never for
  /// ghost rows: what comes to them from beyond is not known.
  bool idle(int j, int k) const noexcept {
    return j >= 0 && k >= 0 && j < rows_y_ && k < rows_z_ && !near_[j + static_cast<std::size_t>(rows_y_) * k];
  }
  /// Owned rows that are not idle.
  std::ptrdiff_t busy() const noexcept { return std::count(near_.begin(), near_.end(), 1); }

private:
  void read(const Grid &grid, ConstView value, const OccupiedRows &before);

  int rows_y_ = 0, rows_z_ = 0;
  std::vector<unsigned char> near_;
};

}  // namespace eulastic
