#include "grid/occupied_rows.hpp"

#include <algorithm>

namespace eulastic {
namespace {

bool occupied(const double *row, int begin, int end) {
  constexpr int piece = 64;
  for (int i = begin; i < end; i += piece) {
    const int stop = i + piece < end ? i + piece : end;
    bool any = false;
#pragma omp simd reduction(| : any)
    for (int m = i; m < stop; ++m) any |= row[m] != 0;
    if (any) return true;
  }
  return false;
}

}  // namespace

void OccupiedRows::find(const Grid &grid, ConstView value) { read(grid, value, {}); }

void OccupiedRows::follow(const Grid &grid, ConstView value) {
  const OccupiedRows before = std::move(*this);
  read(grid, value, before);
}

void OccupiedRows::read(const Grid &grid, ConstView value, const OccupiedRows &before) {
  const Int3 &n = grid.owned(), &ghosts = grid.layout().ghosts;
  const int reach = ghosts[1] + 2, reach_z = ghosts[2] > 0 ? reach : 0;
  rows_y_ = n[1];
  rows_z_ = n[2];
  near_.assign(static_cast<std::size_t>(n[1]) * n[2], 0);
#ifdef EULASTIC_SKIP_NOTHING  // tests/regression/test_same_bits.py
  near_.assign(near_.size(), 1);
  return;
#endif
  for (int k = -ghosts[2]; k < n[2] + ghosts[2]; ++k)
    for (int j = -ghosts[1]; j < n[1] + ghosts[1]; ++j) {
      if (before.idle(j, k) || !occupied(value.row(j, k), -ghosts[0], n[0] + ghosts[0])) continue;
      for (int z = std::max(k - reach_z, 0); z < std::min(k + reach_z + 1, n[2]); ++z)
        for (int y = std::max(j - reach, 0); y < std::min(j + reach + 1, n[1]); ++y)
          near_[y + static_cast<std::size_t>(n[1]) * z] = 1;
    }
}

}  // namespace eulastic
