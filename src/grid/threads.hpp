// How the threads of a rank share the rows of a routine.
#pragma once

#include "base/team.hpp"
#include "grid/box.hpp"

#include <algorithm>
#include <atomic>
#include <numeric>

namespace eulastic {

/// Sets the number of threads per rank, at least 1. Fields that are made afterwards have their pages near the thread
/// that works on them.
inline void set_threads(int count) { ThreadTeam::of_rank().resize(count); }
inline int threads() noexcept { return ThreadTeam::of_rank().size(); }

/// work(n) for every 0 <= n < count: thread t of `team`, at most all of the rank, does t, t + team ..., so that it
/// comes back to the same planes. Within a parallel region the calling thread does all of them.
template <class Work>
void in_parallel(int team, int count, const Work &work) {
  team = std::min(team, count);
  if (team <= 1 || ThreadTeam::is_in_region()) {
    for (int n = 0; n < count; ++n) work(n);
    return;
  }
  ThreadTeam::of_rank().run(team, [&](int thread) {
    for (int n = thread; n < count; n += team) work(n);
  });
}

/// work(n) for every 0 <= n < count, each of them whole on one thread; whoever is free takes the next one. Returns the
/// flops of the routines in them.
template <class Work>
double in_team(int count, const Work &work) {
  std::vector<double> flops(threads(), 0.0);
  std::atomic<int> next{0};
  in_parallel(threads(), threads(), [&](int thread) {
    const TeamMember member(thread, &flops[thread]);
    for (int n = next++; n < count; n = next++) work(n);
  });
  return std::accumulate(flops.begin(), flops.end(), 0.0);
}

/// Piece `part` of `parts` of 0 ... count.
struct Piece {
  std::size_t begin, end;
  Piece(std::size_t count, int part, int parts) : begin(count * part / parts), end(count * (part + 1) / parts) {}
};

/// Part of the owned rows: planes, in 2-D rows.
struct RowPart {
  int number, j_begin, j_end, k_begin, k_end;
  bool first, last;                                 ///< whether it begins and ends where the rank does
  std::vector<Segment> rows(const Box &box) const;  ///< whole
  /// With the layer of ghosts around the owned rows.
  RowPart with_ghosts(const Box &box) const;
};

/// Into how many: as many as there are threads, but none of less than some hundred cells; one for a member of a team.
int row_parts(const Box &box);
RowPart row_part(const Box &box, int part, int parts);

/// work(part) for all parts of the owned rows.
template <class Work>
void in_row_parts(const Box &box, const Work &work) {
  const int parts = row_parts(box);
  in_parallel(parts, parts, [&](int part) { work(row_part(box, part, parts)); });
}

/// work(begin, end) for all parts of `segments`, pointers.
template <class Work>
void in_parts_of(const std::vector<Segment> &segments, const Box &box, const Work &work) {
  const int parts = row_parts(box);
  in_parallel(parts, parts, [&](int part) {
    const Piece piece(segments.size(), part, parts);
    work(segments.data() + piece.begin, segments.data() + piece.end);
  });
}

}  // namespace eulastic
