#include "grid/blocks.hpp"

namespace eulastic {

Sides::Sides(const Grid &grid) : wraps_x(grid.wraps_x()) {
  for (int d = 0; d < 3; ++d) {
    wall[d][0] = grid.touches_low(d);
    wall[d][1] = grid.touches_high(d);
    alone[d] = d >= grid.dimension() || (d == 0 && wraps_x);
  }
}

int StagePass::depth(const Grid &grid, const Sides &sides, int least, int most) {
  int depth = least;
  for (int more = least + 1; more <= std::min(most, grid.spec().ghosts); ++more) {
    double share = 1;
    for (int d = 0; d < grid.dimension(); ++d)
      if (!sides.alone[d] && (grid.processors(d) > 1 || grid.boundary(d) == Boundary::periodic))
        share *= 1 + 2.0 * (more - 1) * grid.processors(d) / grid.cells()[d];
    if (share < 1.25) depth = more;
  }
  return depth;
}

// In the order in which they are done: a block of a field reads what the one below it has written, and may follow it
// slice by slice: neither writes what the other has not yet read then.
StagePass::StagePass(const Grid &grid, const Sides &sides, int depth, int fields)
    : grid_(grid), sides_(sides), depth_(depth) {
  const int last = grid.dimension() - 1, slices = grid.owned()[last], layers = depth - 1;
  const bool flat = last == 1;
  const int begin = flat ? 0 : -sides.low(1, layers), end = flat ? 1 : grid.owned()[1] + layers;
  const int parts = depth == 1 ? row_parts(grid) : 1, rows = depth == 1 ? end - begin : block_rows;
  const int count = depth == 1 ? parts : (end - begin + rows - 1) / rows;
  blocks_ = std::vector<Block>(std::size_t(count) * fields);
  for (int f = 0; f < fields; ++f)
    for (int b = 0; b < count; ++b) {
      Block &block = blocks_[f * count + b];
      const Piece piece(slices, depth == 1 ? b : 0, parts);
      block.field = f;
      block.j_begin = begin + (depth == 1 ? 0 : b * rows);
      block.j_end = block.j_begin + rows;
      block.done = static_cast<int>(piece.begin) - sides.low(last, layers);
      block.end = static_cast<int>(piece.end) + layers;
      if (depth > 1 && b > 0) block.below = &blocks_[f * count + b - 1].done;
    }
}

}  // namespace eulastic
