#include "grid/active_segments.hpp"

#include <algorithm>

namespace eulastic {
namespace {

constexpr int vector_length = 8;

}  // namespace

void ActiveSegments::start(const Grid &grid) {
  points_x_ = grid.points_end(0, true);
  rows_y_ = grid.points_end(1, true);
  rows_z_ = grid.points_end(2, true);
  segments_.clear();
  first_.assign(1, 0);
}

double ActiveSegments::points() const noexcept {
  double sum = 0;
  for (const Segment &s : segments_) sum += s.size();
  return sum;
}

void ActiveSegments::build_all(const Grid &grid) {
  start(grid);
  for (int k = 0; k < rows_z_; ++k)
    for (int j = 0; j < rows_y_; ++j) {
      segments_.push_back({0, points_x_, j, k});
      first_.push_back(static_cast<int>(segments_.size()));
    }
}

void ActiveSegments::build(const Grid &grid, ConstView value, double threshold, int low, int high) {
  start(grid);
  const int low_z = std::min(low, grid.layout().ghosts[2]), high_z = std::min(high, grid.layout().ghosts[2]);
  const int width = points_x_, rows = rows_y_ + low + high;
  mask_.resize(static_cast<std::size_t>(width) * rows * (rows_z_ + low_z + high_z));
  // Rows of "some centre within reach along x is above the threshold".
  unsigned char *mask = mask_.data();
  for (int k = -low_z; k < rows_z_ + high_z; ++k)
    for (int j = -low; j < rows_y_ + high; ++j, mask += width) {
      const double *q = value.row(j, k);
      for (int i = 0; i < width; ++i) mask[i] = q[i - low] >= threshold;
      for (int d = -low + 1; d <= high; ++d)
        for (int i = 0; i < width; ++i) mask[i] |= q[i + d] >= threshold;
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
      const std::size_t row_begin = segments_.size();
      for (int i = 0; i < width; ++i) {
        if (!any[i]) continue;
        int end = i + 1;
        while (end < width && any[end]) ++end;
        const int begin = i / vector_length * vector_length;
        if (segments_.size() > row_begin && begin - segments_.back().i_end < vector_length)
          segments_.back().i_end = end;
        else
          segments_.push_back({begin, end, j, k});
        i = end;
      }
      first_.push_back(static_cast<int>(segments_.size()));
    }
}

}  // namespace eulastic
