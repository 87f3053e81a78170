// The runs of cells, row by row, on which something has to be computed.
#pragma once

#include "grid/box.hpp"
#include "grid/occupied_rows.hpp"

#include <algorithm>

namespace eulastic {

/// Segments ordered by row. Rows cover the points of edge fields: one more than the cells at high walls; those of
/// a band cover the cells and `margin` layers around them.
class ActiveSegments {
public:
  struct Range {
    const Segment *first, *last;
    const Segment *begin() const noexcept { return first; }
    const Segment *end() const noexcept { return last; }
  };

  /// Points (i,j,k) for which one of the centres (i + di, j + dj, k + dk), -low <= di,dj,dk <= high, has
  /// value >= threshold. In whole vectors of 8 points, where the row has them, so a superset; `value` needs that
  /// many ghosts. Idle rows of `rows` are not read.
  void build(const Box &box, ConstView value, const OccupiedRows &rows, double threshold, int low, int high);
  /// Cells, `margin` layers of ghosts included, that with their neighbours (corners too) are neither all 0 nor all 1,
  /// and some more. `value` needs margin + 1 ghosts.
  void build_band(const Box &box, ConstView value, const OccupiedRows &rows, int margin);
  /// Those of `cells` whose value is not 0, and some more.
  void build_within(const Box &box, const ActiveSegments &cells, ConstView value);
  /// The low faces, in all directions, of `cells` and of their upper neighbours, and some more.
  void build_faces(const Box &box, const ActiveSegments &cells);

  Range row(int j, int k) const noexcept {
    const int r = (j - begin_[1]) + rows_y_ * (k - begin_[2]);
    return {segments_.data() + first_[r], segments_.data() + first_[r + 1]};
  }
  /// Whether there is such a row, without segments.
  bool idle(int j, int k) const noexcept {
    return j >= begin_[1] && j < begin_[1] + rows_y_ && row(j, k).begin() == row(j, k).end();
  }
  /// Whether none of the rows j_begin <= j < j_end of plane k has segments; of those that there are.
  bool idle_rows(int j_begin, int j_end, int k) const noexcept {
    const int r = rows_y_ * (k - begin_[2]) - begin_[1];
    return first_[r + j_begin] == first_[r + std::min(j_end, begin_[1] + rows_y_)];
  }
  const std::vector<Segment> &all() const noexcept { return segments_; }
  int rows_y() const noexcept { return rows_y_; }
  int rows_z() const noexcept { return rows_z_; }
  double points() const noexcept;  ///< sum of lengths

private:
  void start(const Int3 &begin, const Int3 &end);
  template <class Flag>
  void build_rows(const Box &box, ConstView value, const OccupiedRows &rows, Flag flag, int wanted, int low, int high);
  void append_row(const unsigned char *marked, int j, int k, std::vector<Segment> *segments) const;
  template <class Append>
  void append_rows(int parts, const Append &append);

  Int3 begin_{};  ///< first point
  int rows_y_ = 0, rows_z_ = 0, points_x_ = 0;
  std::vector<Segment> segments_;
  std::vector<int> first_;
  std::vector<unsigned char> mask_;
};

}  // namespace eulastic
