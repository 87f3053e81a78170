#include "grid/active_segments.hpp"

#include "grid/threads.hpp"

namespace eulastic {
namespace {

constexpr int vector_length = 8;

int round_down(int i) { return i & -vector_length; }

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
// loop runs point by point. Bit 0 of `marked` is the point round_down(begin_[0]).
void ActiveSegments::append_row(const BitRows::Word *marked, int j, int k, std::vector<Segment> *segments) const {
  const int row_end = begin_[0] + points_x_;
  if (skips_nothing()) {
    segments->push_back({begin_[0], row_end, j, k});
    return;
  }
  const std::size_t row_begin = segments->size();
  for (int w = 0; w < words(); ++w) {
    int i = round_down(begin_[0]) + w * BitRows::word_bits;
    for (BitRows::Word left = marked[w]; left != 0; left >>= vector_length, i += vector_length) {
      if ((left & 0xff) == 0) continue;
      const int begin = std::max(i, begin_[0]), end = std::min(i + vector_length, row_end);
      if (segments->size() > row_begin && segments->back().i_end == begin)
        segments->back().i_end = end;
      else
        segments->push_back({begin, end, j, k});
    }
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
    std::vector<BitRows::Word> scratch(words());
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

// Builds the segments of the points that for each of `tests` have a centre within reach that passes it. A test compares
// four values; centres outside the spans are not read and pass none. Bits of near_ are combined along x, then y, then
// z; bit 0 of a row is the point round_down(begin_[0]).
template <class... Tests>
void ActiveSegments::build_near(const Box &box, ConstView value, const OccupiedRows &rows, int low, int high,
                                const Tests &...tests) {
  constexpr int masks = sizeof...(tests);
  const int reach = low + high, low_z = box.dimension() == 2 ? 0 : low, reach_z = box.dimension() == 2 ? 0 : reach;
  const int base = round_down(begin_[0]) - low, first = begin_[0] - low, end = first + points_x_ + reach;
  const int rows_y = rows_y_ + reach, rows_z = rows_z_ + reach_z, parts = row_parts(box);
  for (int m = 0; m < masks; ++m)
    near_[m].reset({{base, begin_[1], begin_[2]}, {end, begin_[1] + rows_y, begin_[2] + rows_z}});
  const auto mark_row = [&](int j, int k) {
    const OccupiedRows::Span span = rows.span(j - low, k - low_z);
    const int from = std::max(span.begin, first), to = std::min(span.end, end);
    if (from >= to) return;
    const double *q = value.row(j - low, k - low_z) + from;
    int m = 0;
    const auto mark = [&](const auto &test) {
      BitRows &near = near_[m++];
      const auto test_at = [&](int i) { return test(load_four(q + i)); };
      set_where(to - from, from - base, test_at, near.row(j, k));
      spread_bits(reach, near.words(), near.row(j, k));
    };
    (mark(tests), ...);
  };
  in_parallel(parts, parts, [&](int part) {
    const Piece planes(rows_z, part, parts);
    for (int k = begin_[2] + static_cast<int>(planes.begin); k < begin_[2] + static_cast<int>(planes.end); ++k) {
      for (int j = begin_[1]; j < begin_[1] + rows_y; ++j) mark_row(j, k);
      for (int m = 0; m < masks; ++m) spread_rows(reach, near_[m].words(), rows_y, near_[m].row(begin_[1], k));
    }
  });
  const int before = begin_[0] - round_down(begin_[0]);
  append_rows(parts, [&](int j, int k, BitRows::Word *marked, std::vector<Segment> *segments) {
    for (int w = 0; w < words(); ++w) {
      marked[w] = bits_between(before, before + points_x_, w);
      for (int m = 0; m < masks; ++m) {
        BitRows::Word any = 0;
        for (int d = 0; d <= reach_z; ++d) any |= near_[m].row(begin_[1] + j, begin_[2] + k + d)[w];
        marked[w] &= any;
      }
    }
    append_row(marked, begin_[1] + j, begin_[2] + k, segments);
  });
}

void ActiveSegments::build(const Box &box, ConstView value, const OccupiedRows &rows, double threshold, int low,
                           int high) {
  reset({0, 0, 0}, {box.points_end(0, true), box.points_end(1, true), box.points_end(2, true)});
  const auto is_large = [threshold](Four q) { return q >= threshold; };
  build_near(box, value, threshold > 0 ? rows : OccupiedRows(), low, high, is_large);
}

void ActiveSegments::build_band(const Box &box, ConstView value, const OccupiedRows &rows, int margin) {
  const Int3 &n = box.cells();
  const int margin_z = box.dimension() == 3 ? margin : 0;
  reset({-margin, -margin, -margin_z}, {n[0] + margin, n[1] + margin, n[2] + margin_z});
  const auto is_not_empty = [](Four q) { return q != 0; };
  const auto is_not_full = [](Four q) { return q != 1; };
  build_near(box, value, rows, 1, 1, is_not_empty, is_not_full);
}

void ActiveSegments::build_within(const Box &box, const ActiveSegments &cells, ConstView value) {
  const Int3 begin = cells.begin_;
  reset(begin, {begin[0] + cells.points_x_, begin[1] + cells.rows_y_, begin[2] + cells.rows_z_});
  const int base = round_down(begin[0]);
  append_rows(row_parts(box), [&](int j, int k, BitRows::Word *marked, std::vector<Segment> *segments) {
    const double *values = value.row(begin[1] + j, begin[2] + k);
    std::fill_n(marked, words(), 0);
    for (const Segment &s : cells.row(begin[1] + j, begin[2] + k))
      for (int i = s.i_begin; i < s.i_end; ++i)
        if (values[i] != 0) set_bits(i - base, i - base + 1, marked);
    append_row(marked, begin[1] + j, begin[2] + k, segments);
  });
}

void ActiveSegments::build_faces(const Box &box, const ActiveSegments &cells) {
  const Int3 begin = cells.begin_;
  reset(begin, {begin[0] + cells.points_x_, begin[1] + cells.rows_y_, begin[2] + cells.rows_z_});
  const int base = round_down(begin[0]);
  append_rows(row_parts(box), [&](int j, int k, BitRows::Word *marked, std::vector<Segment> *segments) {
    std::fill_n(marked, words(), 0);
    const auto mark = [&](int row_j, int row_k) {
      for (const Segment &s : cells.row(begin[1] + row_j, begin[2] + row_k))
        set_bits(s.i_begin - base, std::min(s.i_end + 1, begin[0] + points_x_) - base, marked);
    };
    mark(j, k);
    if (j > 0) mark(j - 1, k);
    if (k > 0) mark(j, k - 1);
    const std::size_t first = segments->size();
    append_row(marked, begin[1] + j, begin[2] + k, segments);
    // Segments of faces end one face after the cells instead of filling a vector.
    for (std::size_t s = first; s < segments->size(); ++s)
      while (!is_set((*segments)[s].i_end - 1 - base, marked)) --(*segments)[s].i_end;
  });
}

}  // namespace eulastic
