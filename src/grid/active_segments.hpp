// Lists, row by row, the runs of cells on which a routine has to work.
#pragma once

#include "grid/bit_rows.hpp"
#include "grid/box.hpp"
#include "grid/occupied_rows.hpp"

#include <algorithm>

namespace eulastic {

/// Segments in the order of rows. The rows cover the points of edge fields, which are one more than the cells at high
/// boundaries; those of a band cover the cells and `margin` ghost layers around them.
class ActiveSegments {
public:
  /// Lists the points (i,j,k) for which a centre (i + di, j + dj, k + dk), -low <= di,dj,dk <= high, has value >=
  /// threshold. Segments consist of whole vectors of 8 points where the row has them, so that they contain further
  /// points. `value` needs low and high ghosts; idle rows of `rows` are not read.
  void build(const Box &box, ConstView value, const OccupiedRows &rows, double threshold, int low, int high);
  /// Lists the cells, including `margin` ghost layers, that are together with their neighbours (corners too) neither
  /// all 0 nor all 1, and further cells to fill vectors. `value` needs margin + 1 ghosts.
  void build_band(const Box &box, ConstView value, const OccupiedRows &rows, int margin);
  /// Lists the points of `cells` whose value is not 0, and further points to fill vectors.
  void build_within(const Box &box, const ActiveSegments &cells, ConstView value);
  /// Lists the low faces, in all directions, of `cells` and of their upper neighbours. Segments begin at a multiple
  /// of 8.
  void build_faces(const Box &box, const ActiveSegments &cells);

  Slice<Segment> row(int j, int k) const noexcept {
    const int r = (j - begin_[1]) + rows_y_ * (k - begin_[2]);
    return {segments_.data() + first_[r], segments_.data() + first_[r + 1]};
  }
  /// Whether row (j, k) exists and has no segments.
  bool idle(int j, int k) const noexcept { return j >= begin_[1] && j < begin_[1] + rows_y_ && row(j, k).empty(); }
  /// Whether the rows j_begin <= j < j_end of plane k, as far as they exist, have no segments.
  bool idle_rows(int j_begin, int j_end, int k) const noexcept {
    const int r = rows_y_ * (k - begin_[2]) - begin_[1];
    return first_[r + j_begin] == first_[r + std::min(j_end, begin_[1] + rows_y_)];
  }
  const std::vector<Segment> &all() const noexcept { return segments_; }
  int rows_y() const noexcept { return rows_y_; }
  int rows_z() const noexcept { return rows_z_; }
  double points() const noexcept;  ///< number of points in all segments

private:
  void reset(const Int3 &begin, const Int3 &end);
  /// Words of a row of points whose first bit is at a multiple of 8 points.
  int words() const noexcept { return BitRows::words_for((begin_[0] & 7) + points_x_); }
  template <class... Tests>
  void build_near(const Box &box, ConstView value, const OccupiedRows &rows, int low, int high, const Tests &...tests);
  void append_row(const BitRows::Word *marked, int j, int k, std::vector<Segment> *segments) const;
  template <class Append>
  void append_rows(int parts, const Append &append);

  Int3 begin_{};  ///< first point
  int rows_y_ = 0, rows_z_ = 0, points_x_ = 0;
  std::vector<Segment> segments_;
  std::vector<int> first_;
  std::array<BitRows, 2> near_;  ///< kept for their memory
};

}  // namespace eulastic
