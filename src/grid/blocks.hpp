// The order in which routines process rows, so that the data of a stencil stay in the second-level cache: blocks of
// rows, and several stages of a stencil in one pass over memory.
#pragma once

#include "grid/split.hpp"
#include "grid/threads.hpp"

#include <algorithm>

namespace eulastic {

/// Number of rows that routines process in all planes before they go on to the next rows: seven planes of this many
/// rows of 128 cells, for three fields, fit into the second-level cache.
inline constexpr int block_rows = 32;

/// Prefetches n doubles into the second-level cache. Hardware prefetchers miss accesses of routines that read several
/// fields, or rows in pieces.
[[gnu::always_inline]] inline void prefetch(const double *values, int n) noexcept {
  for (int i = 0; i < n; i += 8) __builtin_prefetch(values + i, 0, 2);
}

/// The row to prefetch while row `now` of a block of rows in plane `plane` is processed: the row eight rows later in
/// the order of processing, at the end of a block one in the next plane.
struct RowAhead {
  static constexpr int rows = 8;
  int j, k;

  RowAhead(int begin, int end, int now, int plane)
      : j(now + rows < end ? now + rows : std::clamp(now + rows - (end - begin), begin, end - 1)),
        k(now + rows < end ? plane : plane + 1) {}
};

/// Calls row(j, k) for all rows of a part, block by block and plane by plane, and after(first j, end j, k) after the
/// rows of a block in a plane. Always inlined.
template <class Row, class After>
[[gnu::always_inline]] inline void for_rows_in_blocks(const RowPart &part, const Row &row, const After &after) {
  for (int block = part.j_begin; block < part.j_end; block += block_rows)
    for (int k = part.k_begin; k < part.k_end; ++k) {
      const int end = std::min(block + block_rows, part.j_end);
      for (int j = block; j < end; ++j) row(j, k);
      after(block, end, k);
    }
}
template <class Row>
[[gnu::always_inline]] inline void for_rows_in_blocks(const RowPart &part, const Row &row) {
  for_rows_in_blocks(part, row, [](int, int, int) {});
}

/// Layers of points around the owned ones that fused stages recompute instead of exchanging them. There are none behind
/// boundaries, and none along an x that is not split, where rows are periodic by themselves.
struct HaloOverlap {
  bool wraps_x;
  int cells_x;
  bool wall[3][2];     ///< the block touches this boundary of the domain
  bool unextended[3];  ///< no layers along this direction
  int beyond[3] = {};  ///< 1: stages also advance the faces on an open high boundary (normal velocity)

  explicit HaloOverlap(const Box &box);
  /// Fills the first ghost at both ends of a row from its other end if x is periodic and not split. Stages of the same
  /// pass read it.
  [[gnu::always_inline]] void wrap(double *row) const noexcept {
    if (!wraps_x) return;
    row[-1] = row[cells_x - 1];
    row[cells_x] = row[0];
  }
  int low(int d, int layers) const { return unextended[d] || wall[d][0] ? 0 : layers; }
  int high(int d, int layers) const { return unextended[d] || wall[d][1] ? beyond[d] : layers; }
};

/// Fused stages of a stencil that reaches to the next point. Each stage reads the result of the previous one, a slice
/// (a plane, in 2-D a row) behind it and, in 3-D, also a row behind it. A stage is needed at the owned points and,
/// except for the last one, in layers around them, which are recomputed instead of exchanged. Two fields may serve as
/// alternating input and output. The last stage may omit the outermost owned points.
///
/// As in all routines, each thread has slices of its own. It advances them as far as its own data allow, a slice less
/// at the boundaries to other threads with every stage. The omitted slices follow stage by stage, shared by all
/// threads.
class StagePass {
public:
  /// `depth`: number of stages, applied to each of `fields` independent fields.
  /// `layers`: layers that the last stage computes, 0 or -1.
  StagePass(const Box &box, const HaloOverlap &sides, int depth, int fields, int layers = 0)
      : box_(box), sides_(sides), depth_(depth), fields_(fields), first_layers_(depth - 1 + layers) {}

  /// Returns the largest number of stages of a pass, from `least` to `most`, for which the ghost layers suffice and the
  /// recomputed points are less than a quarter of those of the first stage. All ranks obtain the same result.
  static int depth(const Box &box, const Split &split, int least, int most);

  /// A set of slices of one field: all stages, block of rows after block of rows, or the omitted slices of one stage.
  struct Task {
    int thread;
    int field, begin, end;  ///< slices of the first stage
    bool low, high;         ///< whether the slices begin and end at the ends of the rank's block
    int stage = -1;         ///< the only stage, on rows j_begin <= j < j_end of these slices; -1: all stages
    int j_begin = 0, j_end = 0;
  };

  /// Calls work(task) for all tasks, in parallel.
  template <class Work>
  void for_tasks(const Work &work) const {
    const auto run_all = [&](const std::vector<Task> &tasks, int team) {
      in_parallel(team, static_cast<int>(tasks.size()), [&](int t) { work(tasks[t]); });
    };
    const int team = threads_of_pass();
    run_all(tasks(team), team);
    for (int s = 1; s < depth_ && team > 1; ++s) run_all(tasks_between(team, s), team);
  }

  /// Calls rows(stage, first row, end of j) for all rows of a task, plane by plane and including layers. Always
  /// inlined, for routines with EULASTIC_CLONES.
  template <int Dim, class Rows>
  [[gnu::always_inline]] void for_rows(const Task &task, const Rows &rows) const {
    constexpr int last = Dim - 1;
    const Int3 n = box_.cells();
    const auto row = [&](int s, int j, int slice) {
      const int layers = first_layers_ - s;
      return Segment{-sides_.low(0, layers), n[0] + sides_.high(0, layers), j, Dim == 3 ? slice : 0};
    };
    if (task.stage >= 0) {
      for (int slice = task.begin; slice < task.end; ++slice)
        rows(task.stage, row(task.stage, Dim == 3 ? task.j_begin : slice, slice), Dim == 3 ? task.j_end : slice + 1);
      return;
    }
    const int first_row = Dim == 3 ? -sides_.low(1, first_layers_) : 0,
              end_row = Dim == 3 ? n[1] + sides_.beyond[1] + depth_ - 1 : 1;
    const int first_slice = task.begin - (task.low ? sides_.low(last, first_layers_) : 0);
    const int end_slice = task.end + (task.high ? sides_.beyond[last] + depth_ - 1 : 0);
    for (int block = first_row; block < end_row; block += block_rows)
      for (int first = first_slice; first < end_slice; ++first)
        for (int s = 0; s < depth_; ++s) {
          const int slice = first - s, layers = first_layers_ - s;
          if (slice < (task.low ? -sides_.low(last, layers) : task.begin + s)) continue;
          if (slice >= n[last] + sides_.high(last, layers)) continue;
          const int j_begin = Dim == 3 ? std::max(block - s, -sides_.low(1, layers)) : slice;
          const int j_end = Dim == 3 ? std::min(block + block_rows - s, n[1] + sides_.high(1, layers)) : slice + 1;
          rows(s, row(s, j_begin, slice), j_end);
        }
  }

private:
  int threads_of_pass() const;
  std::vector<Task> tasks(int team) const;
  std::vector<Task> tasks_between(int team, int stage) const;

  const Box &box_;
  const HaloOverlap &sides_;
  int depth_, fields_, first_layers_;  ///< first_layers_: layers that the first stage computes
};

}  // namespace eulastic
