#include "grid/active_segments.hpp"

#include <algorithm>

namespace eulastic {
namespace {

constexpr int vector_length = 8;

}  // namespace

void ActiveSegments::start(const Int3 &begin, const Int3 &end) {
  begin_ = begin;
  points_x_ = end[0] - begin[0];
  rows_y_ = end[1] - begin[1];
  rows_z_ = end[2] - begin[2];
  segments_.clear();
  first_.assign(1, 0);
}

double ActiveSegments::points() const noexcept {
  double sum = 0;
  for (const Segment &s : segments_) sum += s.size();
  return sum;
}

void ActiveSegments::build_all(const Grid &grid) {
  start({0, 0, 0}, {grid.points_end(0, true), grid.points_end(1, true), grid.points_end(2, true)});
  for (int k = 0; k < rows_z_; ++k)
    for (int j = 0; j < rows_y_; ++j) {
      segments_.push_back({0, points_x_, j, k});
      first_.push_back(static_cast<int>(segments_.size()));
    }
}

// Runs of points whose mask is `wanted`, as segments of row (j, k).
void ActiveSegments::append_row(const unsigned char *mask, int wanted, int j, int k) {
#ifdef EULASTIC_SKIP_NOTHING  // tests/regression/test_same_bits.py
  segments_.push_back({begin_[0], begin_[0] + points_x_, j, k});
  first_.push_back(static_cast<int>(segments_.size()));
  return;
#endif
  const std::size_t row_begin = segments_.size();
  for (int i = 0; i < points_x_; ++i) {
    if (mask[i] != wanted) continue;
    int end = i + 1;
    while (end < points_x_ && mask[end] == wanted) ++end;
    const int begin = begin_[0] + i / vector_length * vector_length;
    if (segments_.size() > row_begin && begin - segments_.back().i_end < vector_length)
      segments_.back().i_end = begin_[0] + end;
    else
      segments_.push_back({begin, begin_[0] + end, j, k});
    i = end;
  }
  first_.push_back(static_cast<int>(segments_.size()));
}

// Points where the flags of all centres within reach together give `wanted`.
template <class Flag>
void ActiveSegments::build_rows(const Grid &grid, ConstView value, Flag flag, int wanted, int low, int high) {
  const int low_z = grid.dimension() == 3 ? low : 0, high_z = grid.dimension() == 3 ? high : 0;
  const int width = points_x_, rows = rows_y_ + low + high;
  mask_.resize(static_cast<std::size_t>(width) * rows * (rows_z_ + low_z + high_z));
  unsigned char *mask = mask_.data();  // flags of the centres within reach along x
  for (int k = -low_z; k < rows_z_ + high_z; ++k)
    for (int j = -low; j < rows_y_ + high; ++j, mask += width) {
      const double *q = value.row(begin_[1] + j, begin_[2] + k) + begin_[0];
      for (int i = 0; i < width; ++i) mask[i] = flag(q[i - low]);
      for (int d = -low + 1; d <= high; ++d)
        for (int i = 0; i < width; ++i) mask[i] |= flag(q[i + d]);
    }
  std::vector<unsigned char> any(width);
  for (int k = 0; k < rows_z_; ++k)
    for (int j = 0; j < rows_y_; ++j) {
      std::fill(any.begin(), any.end(), 0);
      for (int dk = 0; dk <= low_z + high_z; ++dk)
        for (int dj = 0; dj <= low + high; ++dj) {
          const unsigned char *row = mask_.data() + (static_cast<std::size_t>(k + dk) * rows + j + dj) * width;
          for (int i = 0; i < width; ++i) any[i] |= row[i];
        }
      append_row(any.data(), wanted, begin_[1] + j, begin_[2] + k);
    }
}

void ActiveSegments::build(const Grid &grid, ConstView value, double threshold, int low, int high) {
  start({0, 0, 0}, {grid.points_end(0, true), grid.points_end(1, true), grid.points_end(2, true)});
  build_rows(
      grid, value, [threshold](double q) { return q >= threshold; }, 1, low, high);
}

void ActiveSegments::build_band(const Grid &grid, ConstView value, int margin) {
  const Int3 &n = grid.owned();
  const int margin_z = grid.dimension() == 3 ? margin : 0;
  start({-margin, -margin, -margin_z}, {n[0] + margin, n[1] + margin, n[2] + margin_z});
  build_rows(
      grid, value, [](double q) { return (q != 0) | (q != 1) << 1; }, 3, 1, 1);
}

void ActiveSegments::build_faces(const ActiveSegments &cells) {
  const Int3 begin = cells.begin_;
  start(begin, {begin[0] + cells.points_x_, begin[1] + cells.rows_y_, begin[2] + cells.rows_z_});
  mask_.resize(points_x_);
  for (int k = begin[2]; k < begin[2] + rows_z_; ++k)
    for (int j = begin[1]; j < begin[1] + rows_y_; ++j) {
      std::fill(mask_.begin(), mask_.end(), 0);
      const auto paint = [&](int row_j, int row_k) {
        for (const Segment &s : cells.row(row_j, row_k))
          std::fill_n(mask_.begin() + (s.i_begin - begin[0]), std::min(s.size() + 1, begin[0] + points_x_ - s.i_begin),
                      1);
      };
      paint(j, k);
      if (j > begin[1]) paint(j - 1, k);
      if (k > begin[2]) paint(j, k - 1);
      append_row(mask_.data(), 1, j, k);
    }
}

}  // namespace eulastic
