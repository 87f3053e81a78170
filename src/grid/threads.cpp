#include "grid/threads.hpp"

namespace eulastic {
namespace {

int count_of_threads = 1;

}  // namespace

void set_threads(int count) noexcept { count_of_threads = count; }
int threads() noexcept { return count_of_threads; }

int row_parts(const Grid &grid) {
  constexpr double least = 512;  // cells: in parallel, fewer gain nothing
  const int slices = grid.owned()[grid.dimension() - 1];
  return std::max(1, static_cast<int>(std::min({double(threads()), double(slices), grid.owned_count() / least})));
}

RowPart row_part(const Grid &grid, int part, int parts) {
  const Int3 &n = grid.owned();
  const int slices = n[grid.dimension() - 1];
  const Piece piece(slices, part, parts);
  const int begin = static_cast<int>(piece.begin), end = static_cast<int>(piece.end);
  const bool first = part == 0, last = part == parts - 1;
  if (grid.dimension() == 2) return {part, begin, end, 0, n[2], first, last};
  return {part, 0, n[1], begin, end, first, last};
}

std::vector<Segment> RowPart::rows(const Grid &grid) const {
  std::vector<Segment> all;
  for (int k = k_begin; k < k_end; ++k)
    for (int j = j_begin; j < j_end; ++j) all.push_back({0, grid.owned()[0], j, k});
  return all;
}

RowPart RowPart::with_ghosts(const Grid &grid) const {
  RowPart wide = *this;
  const bool flat = grid.dimension() == 2;
  wide.j_begin -= !flat || first;
  wide.j_end += !flat || last;
  wide.k_begin -= !flat && first;
  wide.k_end += !flat && last;
  return wide;
}

}  // namespace eulastic
