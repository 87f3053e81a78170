#include "grid/ghost_pieces.hpp"

#include "grid/occupied_rows.hpp"
#include "grid/skipping.hpp"

#include <algorithm>

namespace eulastic {
namespace {

// Every row becomes all within `reach` of it, along one direction: `count` of them, `step` words apart.
void spread(std::uint64_t *words, int count, std::ptrdiff_t step, int reach, std::vector<std::uint64_t> *line) {
  line->resize(count);
  for (int r = 0; r < count; ++r) (*line)[r] = words[r * step];
  for (int r = 0; r < count; ++r) {
    std::uint64_t all = 0;
    for (int near = std::max(r - reach, 0); near < std::min(r + reach + 1, count); ++near) all |= (*line)[near];
    words[r * step] = all;
  }
}

}  // namespace

bool GhostPieces::exist(const Box &box) {
  if (skips_nothing() || !box.spans(0)) return false;
  if (box.wraps_x()) return true;
  for (int d = 1; d < box.dimension(); ++d)
    if (!box.spans(d) || !box.is_wall(d)) return true;
  return false;
}

GhostPieces::GhostPieces(const Box &box, ConstView value, const OccupiedRows &rows, int reach)
    : ghosts_(box.layout().ghosts) {
  const Int3 &n = box.cells();
  const int high = n[0] + box.is_wall(0);  // rows end with a face there
  count_ = (high + cells - 1) / cells;
  per_row_ = (count_ + bits - 1) / bits;
  rows_y_ = n[1] + 2 * ghosts_[1] + 1;
  rows_z_ = n[2] + 2 * ghosts_[2] + 1;
  words_.assign(static_cast<std::size_t>(rows_y_) * rows_z_ * per_row_, 0);
  for (int k = -ghosts_[2]; k < n[2] + ghosts_[2]; ++k)
    for (int j = -ghosts_[1]; j < n[1] + ghosts_[1]; ++j) {
      const double *row = value.row(j, k);
      const OccupiedRows::Span span = rows.span(j, k);
      const int begin = std::max(span.begin, -ghosts_[0]), end = std::min(span.end, n[0] + ghosts_[0]);
      if (begin >= end) continue;
      for (int m = std::max(begin - reach, 0) / cells; m < count_ && m * cells < end + reach; ++m)
        if (OccupiedRows::any(row, std::max(begin, m * cells - reach), std::min(end, (m + 1) * cells + reach)))
          words_[word(j, k, m)] |= std::uint64_t{1} << (m % bits);
    }
  std::vector<std::uint64_t> line;
  const std::ptrdiff_t plane = static_cast<std::ptrdiff_t>(rows_y_) * per_row_;
  for (int k = 0; k < rows_z_; ++k)
    for (int w = 0; w < per_row_; ++w) spread(&words_[k * plane + w], rows_y_, per_row_, reach, &line);
  if (box.dimension() == 3)
    for (std::ptrdiff_t w = 0; w < plane; ++w) spread(&words_[w], rows_z_, plane, reach, &line);
  for (int k = 0; k < n[2]; ++k)
    for (int j = 0; j < n[1]; ++j) {
      const bool first = holds(j, k, 0), last = holds(j, k, count_ - 1);
      std::fill_n(&words_[word(j, k, 0)], per_row_, 0);
      words_[word(j, k, 0)] |= std::uint64_t{first};
      words_[word(j, k, count_ - 1)] |= std::uint64_t{last} << ((count_ - 1) % bits);
    }
}

bool GhostPieces::hold(const GhostPieces &other) const noexcept {
  for (std::size_t w = 0; w < words_.size(); ++w)
    if ((other.words_[w] & ~words_[w]) != 0) return false;
  return true;
}

}  // namespace eulastic
