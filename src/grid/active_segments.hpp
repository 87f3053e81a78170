// The runs of cells, row by row, on which something has to be computed.
#pragma once

#include "grid/grid.hpp"

namespace eulastic {

/// Segments ordered by row. Rows cover the points of edge fields: one more than the cells at high walls.
class ActiveSegments {
public:
  struct Range {
    const Segment *first, *last;
    const Segment *begin() const noexcept { return first; }
    const Segment *end() const noexcept { return last; }
  };

  /// Points (i,j,k) for which one of the centres (i + di, j + dj, k + dk), -low <= di,dj,dk <= high, has
  /// value >= threshold. Starts are rounded down to a multiple of 8 and gaps shorter than 8 are closed, so a
  /// superset; `value` needs that many ghosts.
  void build(const Grid &grid, ConstView value, double threshold, int low, int high);
  /// Everything.
  void build_all(const Grid &grid);

  Range row(int j, int k) const noexcept {
    const int r = j + rows_y_ * k;
    return {segments_.data() + first_[r], segments_.data() + first_[r + 1]};
  }
  const std::vector<Segment> &all() const noexcept { return segments_; }
  int rows_y() const noexcept { return rows_y_; }
  int rows_z() const noexcept { return rows_z_; }
  int points_x() const noexcept { return points_x_; }
  double points() const noexcept;  ///< sum of lengths

private:
  void start(const Grid &grid);

  int rows_y_ = 0, rows_z_ = 0, points_x_ = 0;
  std::vector<Segment> segments_;
  std::vector<int> first_;
  std::vector<unsigned char> mask_;
};

}  // namespace eulastic
