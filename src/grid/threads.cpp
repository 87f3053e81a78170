#include "grid/threads.hpp"

namespace eulastic {

int row_parts(const Box &box) {
  constexpr double least = 512;  // cells per part: smaller parts gain nothing from parallel processing
  if (TeamMember::is_here()) return 1;
  const int slices = box.cells()[box.dimension() - 1];
  return std::max(1, static_cast<int>(std::min({double(threads()), double(slices), box.cell_count() / least})));
}

RowPart row_part(const Box &box, int part, int parts) {
  const Int3 &n = box.cells();
  const int slices = n[box.dimension() - 1];
  const Piece piece(slices, part, parts);
  const int begin = static_cast<int>(piece.begin), end = static_cast<int>(piece.end);
  const bool first = part == 0, last = part == parts - 1;
  if (box.dimension() == 2) return {part, begin, end, 0, n[2], first, last};
  return {part, 0, n[1], begin, end, first, last};
}

std::vector<Segment> RowPart::rows(const Box &box) const {
  std::vector<Segment> all;
  for (int k = k_begin; k < k_end; ++k)
    for (int j = j_begin; j < j_end; ++j) all.push_back({0, box.cells()[0], j, k});
  return all;
}

RowPart RowPart::with_ghosts(const Box &box) const {
  RowPart wide = *this;
  const bool flat = box.dimension() == 2;
  wide.j_begin -= !flat || first;
  wide.j_end += !flat || last;
  wide.k_begin -= !flat && first;
  wide.k_end += !flat && last;
  return wide;
}

}  // namespace eulastic
