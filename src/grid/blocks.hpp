// In what order verbs go through rows, so that what a stencil reads stays in the second-level cache: blocks of rows,
// and several stages of a stencil in one pass over memory.
#pragma once

#include "grid/split.hpp"
#include "grid/threads.hpp"

#include <algorithm>

namespace eulastic {

/// Verbs go through all of z for so many rows at a time: of 128 cells, three fields of them seven planes deep fit the
/// second-level cache.
inline constexpr int block_rows = 32;

/// Asks for n values, into the second-level cache: where a verb reads several fields, or rows in pieces, processors do
/// not foresee what it needs from memory.
[[gnu::always_inline]] inline void prefetch(const double *values, int n) noexcept {
  for (int i = 0; i < n; i += 8) __builtin_prefetch(values + i, 0, 2);
}

/// The row to ask memory for while row j of a block of rows in plane k is worked on: far enough on to be there in time,
/// near enough to take little of the cache until then.
struct RowAhead {
  static constexpr int rows = 8;
  int j, k;

  RowAhead(int begin, int end, int now, int plane)
      : j(now + rows < end ? now + rows : std::clamp(now + rows - (end - begin), begin, end - 1)),
        k(now + rows < end ? plane : plane + 1) {}
};

/// row(j, k) for all rows of a part in that order, and after(first row, end of j, k) after those of a block in a plane;
/// inlined.
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

/// Where a rank ends: how many layers of points around the owned ones are computed again by stages. None behind walls,
/// and none of an x that is not split, which wraps around within the row.
struct Sides {
  bool wraps_x;
  int cells_x;
  bool wall[3][2];
  bool alone[3];
  int beyond[3] = {};  ///< 1: stages come to the faces of an open high side too, those of the component normal to it

  explicit Sides(const Box &box);
  /// Wraps a row around by one point, where x does: for stages of the same pass that read it.
  [[gnu::always_inline]] void wrap(double *row) const noexcept {
    if (!wraps_x) return;
    row[-1] = row[cells_x - 1];
    row[cells_x] = row[0];
  }
  int low(int d, int layers) const { return alone[d] || wall[d][0] ? 0 : layers; }
  int high(int d, int layers) const { return alone[d] || wall[d][1] ? beyond[d] : layers; }
};

/// Stages of a stencil that reaches to the next point, each of which reads what the one before it has written: a slice
/// (a plane, in 2-D a row) behind it and, in 3-D, a row behind it too. A stage is needed at the owned points and, for
/// those after it, in layers around them, which are computed again instead of exchanged. Stages may write two fields in
/// turn, each over what the one before the last has left. The last stage may leave the outermost owned points out.
///
/// Threads have slices of their own, like with any verb. Each goes as far as it can with them, a slice less at the
/// other threads' sides with every stage; what is left there, stage by stage, is done together then.
class StagePass {
public:
  /// `depth` stages, each of `fields` fields that do not see each other.
  /// `layers` of the last one: 0, or -1.
  StagePass(const Box &box, const Sides &sides, int depth, int fields, int layers = 0)
      : box_(box), sides_(sides), depth_(depth), fields_(fields), most_(depth - 1 + layers) {}

  /// The most stages of a pass, `least` to `most`: ghosts must reach, and what is computed again stay below a quarter
  /// of the first stage. Every rank finds the same.
  static int depth(const Box &box, const Split &split, int least, int most);

  /// Slices of a field that go together: all stages, a block of rows after the other, or what is left of one stage.
  struct Task {
    int thread;
    int field, begin, end;  ///< slices of the first stage
    bool low, high;         ///< whether they end where the rank does
    int stage = -1;         ///< the only one, on rows j_begin <= j < j_end of these slices; -1: all
    int j_begin = 0, j_end = 0;
  };

  /// work(task) for all of them.
  template <class Work>
  void for_tasks(const Work &work) const {
    const auto go = [&](const std::vector<Task> &tasks, int team) {
      in_parallel(team, static_cast<int>(tasks.size()), [&](int t) { work(tasks[t]); });
    };
    const int team = threads_of_pass();
    go(tasks(team), team);
    for (int s = 1; s < depth_ && team > 1; ++s) go(tasks_between(team, s), team);
  }

  /// rows(stage, first row, end of j) for all rows of a task, plane by plane, layers included; inlined, for verbs that
  /// are EULASTIC_CLONES.
  template <int Dim, class Rows>
  [[gnu::always_inline]] void go(const Task &task, const Rows &rows) const {
    constexpr int last = Dim - 1;
    const Int3 n = box_.cells();
    const auto row = [&](int s, int j, int slice) {
      const int layers = most_ - s;
      return Segment{-sides_.low(0, layers), n[0] + sides_.high(0, layers), j, Dim == 3 ? slice : 0};
    };
    if (task.stage >= 0) {
      for (int slice = task.begin; slice < task.end; ++slice)
        rows(task.stage, row(task.stage, Dim == 3 ? task.j_begin : slice, slice), Dim == 3 ? task.j_end : slice + 1);
      return;
    }
    const int first_row = Dim == 3 ? -sides_.low(1, most_) : 0,
              end_row = Dim == 3 ? n[1] + sides_.beyond[1] + depth_ - 1 : 1;
    const int first_slice = task.begin - (task.low ? sides_.low(last, most_) : 0);
    const int end_slice = task.end + (task.high ? sides_.beyond[last] + depth_ - 1 : 0);
    for (int block = first_row; block < end_row; block += block_rows)
      for (int first = first_slice; first < end_slice; ++first)
        for (int s = 0; s < depth_; ++s) {
          const int slice = first - s, layers = most_ - s;
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
  const Sides &sides_;
  int depth_, fields_, most_;  ///< layers of the first stage
};

}  // namespace eulastic
