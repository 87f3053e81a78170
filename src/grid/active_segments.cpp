#include "grid/active_segments.hpp"

#include "grid/threads.hpp"

#include <cstdint>
#include <cstring>

namespace eulastic {
namespace {

constexpr int vector_length = 8;

// Whether any of n <= 8 flags is set.
bool any_set(const unsigned char *flags, int n) {
  std::uint64_t all_flags = 0;
  static_assert(sizeof(all_flags) == vector_length);
  if (n < vector_length) return std::memchr(flags, 1, n) != nullptr;
  std::memcpy(&all_flags, flags, sizeof(all_flags));
  return all_flags != 0;
}

// Computes to[i] |= from[i]. If `to` and `from` overlap, `from` must lie after `to`: its bytes are read before they are
// written.
void join(std::size_t n, const unsigned char *from, unsigned char *to) {
  for (std::size_t i = 0; i < n; ++i) to[i] |= from[i];
}
void compare(std::size_t n, unsigned char wanted, unsigned char *flags) {
  for (std::size_t i = 0; i < n; ++i) flags[i] = flags[i] == wanted;
}

}  // namespace

void ActiveSegments::reset(const Int3 &begin, const Int3 &end) {
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

// Appends the segments of row (j, k) that cover all marked points, in whole vectors because the remainder of a vector
// loop runs point by point. A null `marked` marks no point.
void ActiveSegments::append_row(const unsigned char *marked, int j, int k, std::vector<Segment> *segments) const {
  if (skips_nothing()) {
    segments->push_back({begin_[0], begin_[0] + points_x_, j, k});
    return;
  }
  const std::size_t row_begin = segments->size();
  for (int i = 0, count; marked && i < points_x_; i += count) {
    count = std::min(vector_length - ((begin_[0] + i) & (vector_length - 1)), points_x_ - i);
    if (!any_set(marked + i, count)) continue;
    const int begin = begin_[0] + i, end = begin + count;
    if (segments->size() > row_begin && segments->back().i_end == begin)
      segments->back().i_end = end;
    else
      segments->push_back({begin, end, j, k});
  }
}

// Calls append(j, k, scratch, segments) for every row, counted from 0, to append the segments of that row. Planes are
// processed in parallel.
template <class Append>
void ActiveSegments::append_rows(int parts, const Append &append) {
  struct PartSegments {
    std::vector<Segment> segments;
    std::vector<int> ends;  // of every row
  };
  std::vector<PartSegments> found(parts);
  in_parallel(parts, parts, [&](int part) {
    const Piece planes(rows_z_, part, parts);
    PartSegments &own = found[part];
    std::vector<unsigned char> scratch(points_x_);
    for (int k = static_cast<int>(planes.begin); k < static_cast<int>(planes.end); ++k)
      for (int j = 0; j < rows_y_; ++j) {
        append(j, k, scratch.data(), &own.segments);
        own.ends.push_back(static_cast<int>(own.segments.size()));
      }
  });
  for (const PartSegments &own : found) {
    const int before = static_cast<int>(segments_.size());
    for (const int end : own.ends) first_.push_back(before + end);
    segments_.insert(segments_.end(), own.segments.begin(), own.segments.end());
  }
}

// Builds the segments of all points for which the bitwise or of flag(value) over the centres within reach equals
// `wanted`. Idle rows, where all values are 0, do not have all wanted flags by themselves. Flags are combined along x,
// then y, then z.
template <class Flag>
void ActiveSegments::build_rows(const Box &box, ConstView value, const OccupiedRows &rows, Flag flag, int wanted,
                                int low, int high) {
  const bool flat = box.dimension() == 2, skip = flag(0.0) != wanted;
  const int reach = low + high, reach_z = flat ? 0 : reach, low_z = flat ? 0 : low, parts = row_parts(box);
  const std::size_t width = points_x_, plane = width * rows_y_;
  std::vector<unsigned char> marked(static_cast<std::size_t>(rows_y_) * (rows_z_ + reach_z), 0);
  mask_.resize(plane * (rows_z_ + reach_z));  // flags combined along x and y, valid in the rows that `marked` names
  const auto mark_plane = [&](int k, std::vector<unsigned char> &flags) {
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
      for (int done = 1, step; done <= reach; done += step) {  // `done` flags are combined already, of reach + 1
        step = std::min(done, reach + 1 - done);
        join(flags.size() - step, flags.data() + step, flags.data());
      }
      for (int row = std::max(0, j - reach); row <= std::min(j, rows_y_ - 1); ++row) {
        unsigned char *mask = mask_.data() + k * plane + row * width, &known = marked[k * std::size_t(rows_y_) + row];
        if (!known) std::fill_n(mask, width, 0);
        known = 1;
        join(width, flags.data(), mask);
      }
    }
  };
  in_parallel(parts, parts, [&](int part) {
    const Piece planes(rows_z_ + reach_z, part, parts);
    std::vector<unsigned char> flags(width + reach);
    for (std::size_t k = planes.begin; k < planes.end; ++k) mark_plane(static_cast<int>(k), flags);
  });
  append_rows(parts, [&](int j, int k, unsigned char *sum, std::vector<Segment> *segments) {
    bool any = false;
    for (int d = 0; d <= reach_z; ++d) {
      if (!marked[(k + d) * std::size_t(rows_y_) + j]) continue;
      if (!any) std::fill_n(sum, width, 0);
      any = true;
      const unsigned char *mask = mask_.data() + (k + d) * plane + j * width;
      join(width, mask, sum);
    }
    if (any) compare(width, static_cast<unsigned char>(wanted), sum);
    append_row(any ? sum : nullptr, begin_[1] + j, begin_[2] + k, segments);
  });
}

void ActiveSegments::build(const Box &box, ConstView value, const OccupiedRows &rows, double threshold, int low,
                           int high) {
  reset({0, 0, 0}, {box.points_end(0, true), box.points_end(1, true), box.points_end(2, true)});
  build_rows(
      box, value, rows, [threshold](double q) { return static_cast<unsigned char>(q >= threshold); }, 1, low, high);
}

void ActiveSegments::build_band(const Box &box, ConstView value, const OccupiedRows &rows, int margin) {
  const Int3 &n = box.cells();
  const int margin_z = box.dimension() == 3 ? margin : 0;
  reset({-margin, -margin, -margin_z}, {n[0] + margin, n[1] + margin, n[2] + margin_z});
  build_rows(
      box, value, rows, [](double q) { return static_cast<unsigned char>((q != 0) | (q != 1) << 1); }, 3, 1, 1);
}

void ActiveSegments::build_within(const Box &box, const ActiveSegments &cells, ConstView value) {
  const Int3 begin = cells.begin_;
  reset(begin, {begin[0] + cells.points_x_, begin[1] + cells.rows_y_, begin[2] + cells.rows_z_});
  append_rows(row_parts(box), [&](int j, int k, unsigned char *mask, std::vector<Segment> *segments) {
    const double *values = value.row(begin[1] + j, begin[2] + k) + begin[0];
    std::fill_n(mask, points_x_, 0);
    for (const Segment &s : cells.row(begin[1] + j, begin[2] + k))
      for (int i = s.i_begin - begin[0]; i < s.i_end - begin[0]; ++i) mask[i] = values[i] != 0;
    append_row(mask, begin[1] + j, begin[2] + k, segments);
  });
}

void ActiveSegments::build_faces(const Box &box, const ActiveSegments &cells) {
  const Int3 begin = cells.begin_;
  reset(begin, {begin[0] + cells.points_x_, begin[1] + cells.rows_y_, begin[2] + cells.rows_z_});
  append_rows(row_parts(box), [&](int j, int k, unsigned char *mask, std::vector<Segment> *segments) {
    std::fill_n(mask, points_x_, 0);
    const auto mark = [&](int row_j, int row_k) {
      for (const Segment &s : cells.row(begin[1] + row_j, begin[2] + row_k))
        std::fill_n(mask + (s.i_begin - begin[0]), std::min(s.size() + 1, begin[0] + points_x_ - s.i_begin), 1);
    };
    mark(j, k);
    if (j > 0) mark(j - 1, k);
    if (k > 0) mark(j, k - 1);
    const std::size_t first = segments->size();
    append_row(mask, begin[1] + j, begin[2] + k, segments);
    // Segments of faces end one face after the cells instead of filling a vector.
    for (std::size_t s = first; s < segments->size(); ++s)
      while (!mask[(*segments)[s].i_end - 1 - begin[0]]) --(*segments)[s].i_end;
  });
}

}  // namespace eulastic
