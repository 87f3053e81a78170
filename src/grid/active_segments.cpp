#include "grid/active_segments.hpp"

#include <algorithm>
#include <cstring>

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

// Runs of vectors of row (j, k) of which a point is marked; none if `marked` is null. Whole ones: the last points of a
// run that ends within a vector would be done one by one.
void ActiveSegments::append_row(const unsigned char *marked, int j, int k) {
#ifdef EULASTIC_SKIP_NOTHING  // tests/regression/test_same_bits.py
  segments_.push_back({begin_[0], begin_[0] + points_x_, j, k});
  first_.push_back(static_cast<int>(segments_.size()));
  return;
#endif
  const std::size_t row_begin = segments_.size();
  for (int i = 0; marked && i < points_x_; i += vector_length) {
    const int count = std::min(vector_length, points_x_ - i);
    if (std::memchr(marked + i, 1, count) == nullptr) continue;
    const int begin = begin_[0] + i, end = begin + count;
    if (segments_.size() > row_begin && segments_.back().i_end == begin)
      segments_.back().i_end = end;
    else
      segments_.push_back({begin, end, j, k});
  }
  first_.push_back(static_cast<int>(segments_.size()));
}

// Points where the flags of all centres within reach together give `wanted`, which idle rows alone do not. Reach by
// reach: along x, y and z.
template <class Flag>
void ActiveSegments::build_rows(const Grid &grid, ConstView value, const OccupiedRows &rows, Flag flag, int wanted,
                                int low, int high) {
  const bool flat = grid.dimension() == 2, skip = flag(0.0) != wanted;
  const int reach = low + high, reach_z = flat ? 0 : reach, low_z = flat ? 0 : low;
  const std::size_t width = points_x_, plane = width * rows_y_;
  std::vector<unsigned char> flags(width + reach), marked(static_cast<std::size_t>(rows_y_) * (rows_z_ + reach_z), 0);
  mask_.resize(plane * (rows_z_ + reach_z));  // what is within reach along x and y, on the rows that are `marked`
  const auto touch = [&](int row, int k) {
    unsigned char *mask = mask_.data() + k * plane + row * width, &known = marked[k * std::size_t(rows_y_) + row];
    if (!known) std::fill_n(mask, width, 0);
    known = 1;
    return mask;
  };
  for (int k = 0; k < rows_z_ + reach_z; ++k)
    for (int j = 0; j < rows_y_ + reach; ++j) {
      const int from_j = begin_[1] + j - low, from_k = begin_[2] + k - low_z;
      if (skip && rows.idle(from_j, from_k)) continue;
      const int first = begin_[0] - low, end = first + static_cast<int>(flags.size());
      const OccupiedRows::Span span = skip ? rows.span(from_j, from_k) : OccupiedRows::Span{first, end};
      const double *q = value.row(from_j, from_k) + first;
      unsigned char any = 0;
      std::fill(flags.begin(), flags.end(), 0);
#pragma omp simd reduction(| : any)
      for (int i = std::max(span.begin, first) - first; i < std::min(span.end, end) - first; ++i)
        any |= flags[i] = flag(q[i]);
      if (any == 0) continue;
      for (int done = 1, step; done <= reach; done += step) {  // of reach + 1 flags
        step = std::min(done, reach + 1 - done);
        for (std::size_t i = 0; i + step < flags.size(); ++i) flags[i] |= flags[i + step];
      }
      for (int row = std::max(0, j - reach); row <= std::min(j, rows_y_ - 1); ++row) {
        unsigned char *mask = touch(row, k);
        for (std::size_t i = 0; i < width; ++i) mask[i] |= flags[i];
      }
    }
  for (int k = 0; k < rows_z_; ++k)
    for (int j = 0; j < rows_y_; ++j) {
      for (int d = 1; d <= reach_z; ++d) {
        if (!marked[(k + d) * std::size_t(rows_y_) + j]) continue;
        unsigned char *mask = touch(j, k);
        for (std::size_t i = 0; i < width; ++i) mask[i] |= mask[i + d * plane];
      }
      unsigned char *mask = nullptr;
      if (marked[k * std::size_t(rows_y_) + j]) {
        mask = touch(j, k);
        for (std::size_t i = 0; i < width; ++i) mask[i] = mask[i] == wanted;
      }
      append_row(mask, begin_[1] + j, begin_[2] + k);
    }
}

void ActiveSegments::build(const Grid &grid, ConstView value, const OccupiedRows &rows, double threshold, int low,
                           int high) {
  start({0, 0, 0}, {grid.points_end(0, true), grid.points_end(1, true), grid.points_end(2, true)});
  build_rows(
      grid, value, rows, [threshold](double q) { return static_cast<unsigned char>(q >= threshold); }, 1, low, high);
}

void ActiveSegments::build_band(const Grid &grid, ConstView value, const OccupiedRows &rows, int margin) {
  const Int3 &n = grid.owned();
  const int margin_z = grid.dimension() == 3 ? margin : 0;
  start({-margin, -margin, -margin_z}, {n[0] + margin, n[1] + margin, n[2] + margin_z});
  build_rows(
      grid, value, rows, [](double q) { return static_cast<unsigned char>((q != 0) | (q != 1) << 1); }, 3, 1, 1);
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
      append_row(mask_.data(), j, k);
      for (std::size_t s = first_[first_.size() - 2]; s < segments_.size(); ++s)  // one face more than cells, not eight
        while (!mask_[segments_[s].i_end - 1 - begin[0]]) --segments_[s].i_end;
    }
}

}  // namespace eulastic
