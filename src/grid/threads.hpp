// Distribution of the rows of a routine over the threads of a rank.
#pragma once

#include "base/team.hpp"
#include "grid/box.hpp"

#include <algorithm>
#include <atomic>
#include <numeric>

namespace eulastic {

/// Sets the number of threads per rank, at least 1. Pages of fields that are created afterwards are placed near the
/// thread that works on them.
inline void set_threads(int count) { ThreadTeam::team_of_rank().resize(count); }
inline int threads() noexcept { return ThreadTeam::team_of_rank().size(); }

/// Calls work(n) for every 0 <= n < count. Thread t of `team` threads (at most those of the rank) takes n = t, t + team
/// ..., so that it always works on the same planes. Within a parallel region the calling thread does all the work.
template <class Work>
void in_parallel(int team, int count, const Work &work) {
  team = std::min(team, count);
  if (team <= 1 || ThreadTeam::is_in_parallel_region()) {
    for (int n = 0; n < count; ++n) work(n);
    return;
  }
  ThreadTeam::team_of_rank().run(team, [&](int thread) {
    for (int n = thread; n < count; n += team) work(n);
  });
}

/// Calls work(n) for every 0 <= n < count, each on a single thread; a free thread takes the next n. Returns the flops
/// of the routines that were called.
template <class Work>
double in_parallel_tasks(int count, const Work &work) {
  std::vector<double> flops(threads(), 0.0);
  std::atomic<int> next{0};
  in_parallel(threads(), threads(), [&](int thread) {
    const TeamMember member(thread, &flops[thread]);
    for (int n = next++; n < count; n = next++) work(n);
  });
  return std::accumulate(flops.begin(), flops.end(), 0.0);
}

/// Indices begin <= n < end of piece `part` of `parts` of [0, count).
struct Piece {
  std::size_t begin, end;
  Piece(std::size_t count, int part, int parts) : begin(count * part / parts), end(count * (part + 1) / parts) {}
};

/// A part of the owned rows: some of the planes, in 2-D some of the rows.
struct RowPart {
  int number, j_begin, j_end, k_begin, k_end;
  bool first, last;                                 ///< whether the part begins and ends where the block does
  std::vector<Segment> rows(const Box &box) const;  ///< all rows of the part, without ghosts
  /// Returns the part extended by the first layer of ghosts around the owned rows.
  RowPart with_ghosts(const Box &box) const;
};

/// Returns the number of parts: that of the threads, or fewer so that parts have at least 512 cells; one for a member
/// of a team.
int row_parts(const Box &box);
RowPart row_part(const Box &box, int part, int parts);

/// Calls work(part) for all parts of the owned rows, in parallel.
template <class Work>
void in_row_parts(const Box &box, const Work &work) {
  const int parts = row_parts(box);
  in_parallel(parts, parts, [&](int part) { work(row_part(box, part, parts)); });
}

/// Calls work(begin, end) for all parts of `segments`, in parallel; begin and end are pointers.
template <class Work>
void in_segment_parts(const std::vector<Segment> &segments, const Box &box, const Work &work) {
  const int parts = row_parts(box);
  in_parallel(parts, parts, [&](int part) {
    const Piece piece(segments.size(), part, parts);
    work(segments.data() + piece.begin, segments.data() + piece.end);
  });
}

}  // namespace eulastic
