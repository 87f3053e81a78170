// In what order verbs go through rows, so that what a stencil reads stays in the second-level cache: blocks of rows,
// and several stages of a stencil in one pass over memory.
#pragma once

#include "grid/threads.hpp"

#include <atomic>
#include <thread>

namespace eulastic {

/// Verbs go through all of z for so many rows at a time: of 128 cells, three fields of them seven planes deep fit the
/// second-level cache.
inline constexpr int block_rows = 32;

/// row(j, k) for all rows of a part in that order; inlined.
template <class Row>
[[gnu::always_inline]] inline void for_rows_in_blocks(const RowPart &part, const Row &row) {
  for (int block = part.j_begin; block < part.j_end; block += block_rows)
    for (int k = part.k_begin; k < part.k_end; ++k)
      for (int j = block; j < std::min(block + block_rows, part.j_end); ++j) row(j, k);
}

/// Where a rank ends: how many layers of points around the owned ones are computed again by stages. None behind walls,
/// and none of an x that is not split, which wraps around within the row.
struct Sides {
  bool wraps_x;
  bool wall[3][2];
  bool alone[3];

  explicit Sides(const Grid &grid);
  int low(int d, int layers) const { return alone[d] || wall[d][0] ? 0 : layers; }
  int high(int d, int layers) const { return alone[d] || wall[d][1] ? 0 : layers; }
};

/// Stages of a stencil that reaches to the next point, each of which reads what the one before it has written: a slice
/// (a plane, in 2-D a row) behind it and, in 3-D, a row behind it too. A stage is needed at the owned points and, for
/// those after it, in layers around them, which are computed again instead of exchanged. Stages may write two fields in
/// turn, each over what the one before the last has left.
class StagePass {
public:
  /// `depth` stages, each of `fields` fields that do not see each other. One thread after the other follows the one of
  /// lower rows, but a stage alone is split like any verb.
  StagePass(const Grid &grid, const Sides &sides, int depth, int fields);

  /// The most stages of a pass, `least` to `most`: ghosts must reach, and what is computed again stay below a quarter
  /// of the first stage. Every rank finds the same.
  static int depth(const Grid &grid, const Sides &sides, int least, int most);

  /// A block of rows of a field; in 2-D all rows.
  struct alignas(64) Block {
    int field, j_begin, j_end, end;           ///< of the first stage; one past the last slice of the last stage
    const std::atomic<int> *below = nullptr;  ///< slices that the block of lower rows has done; null: there is none
    std::atomic<int> done{};
  };

  /// work(block) for all of them.
  template <class Work>
  void for_blocks(const Work &work) {
    in_parallel(row_parts(grid_), static_cast<int>(blocks_.size()), [&](int b) { work(blocks_[b]); });
  }

  /// rows(stage, first row, end of j) for all rows of a block, plane by plane, layers included; inlined, for verbs that
  /// are EULASTIC_CLONES.
  template <int Dim, class Rows>
  [[gnu::always_inline]] void go(Block &block, const Rows &rows) const {
    constexpr int last = Dim - 1;
    const Int3 n = grid_.owned();
    for (int first = block.done; first < block.end; ++first) {
      while (block.below && block.below->load(std::memory_order_acquire) <= first) std::this_thread::yield();
      for (int s = 0; s < depth_; ++s) {
        const int slice = first - s, layers = depth_ - 1 - s;
        if (slice < -sides_.low(last, layers) || slice >= n[last] + sides_.high(last, layers)) continue;
        const int j_begin = Dim == 3 ? std::max(block.j_begin - s, -sides_.low(1, layers)) : slice;
        const int j_end = Dim == 3 ? std::min(block.j_end - s, n[1] + sides_.high(1, layers)) : slice + 1;
        rows(s, Segment{-sides_.low(0, layers), n[0] + sides_.high(0, layers), j_begin, Dim == 3 ? slice : 0}, j_end);
      }
      block.done.store(first + 1, std::memory_order_release);
    }
  }

private:
  const Grid &grid_;
  const Sides &sides_;
  int depth_;
  std::vector<Block> blocks_;
};

}  // namespace eulastic
