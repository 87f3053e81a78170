// Threads of a rank, which share the rows of a verb. The first alone calls MPI and PETSc.
#pragma once

#include "base/team.hpp"
#include "grid/box.hpp"

#include <algorithm>
#include <atomic>
#include <numeric>
#ifdef __SANITIZE_THREAD__
#include <thread>
#endif

namespace eulastic {

/// Threads per rank, at least 1; to be set before there are fields, whose pages then lie near who works on them.
void set_threads(int count) noexcept;
int threads() noexcept;

/// work(n) for every 0 <= n < count: thread t of `team` does t, t + team ..., so that it comes back to the same planes.
/// A member of a team does all of them.
template <class Work>
void in_parallel(int team, int count, const Work &work) {
  if (team <= 1 || TeamMember::is_here()) {
    for (int n = 0; n < count; ++n) work(n);
    return;
  }
#ifdef __SANITIZE_THREAD__  // which does not know how the threads of OpenMP wait for each other
  std::vector<std::thread> all;
  for (int t = 0; t < team; ++t)
    all.emplace_back([&, t] {
      for (int n = t; n < count; n += team) work(n);
    });
  for (std::thread &one : all) one.join();
#else
#pragma omp parallel for schedule(static, 1) num_threads(team)
  for (int n = 0; n < count; ++n) work(n);
#endif
}

/// work(n) for every 0 <= n < count, each of them all on one thread, as members of a team that take one after the
/// other. Returns the flops of the verbs in them.
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
