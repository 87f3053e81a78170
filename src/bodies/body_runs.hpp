// Sums over the cells of bodies by runs within rows: the bits do not depend on the ranks, and exact sums are needed per
// run only, not per cell.
#pragma once

#include "base/exact_sum.hpp"
#include "bodies/body_owners.hpp"
#include "bodies/unwrap.hpp"
#include "field/boundaries.hpp"
#include "field/phase.hpp"
#include "grid/box.hpp"
#include "grid/threads.hpp"

#include <algorithm>
#include <array>

namespace eulastic {

/// Cells [begin, end) of a row with the label of one body that lie in one block of ExactSums by global x index. Runs,
/// and sums over their lanes, do not depend on the ranks.
struct Run {
  const Phase &phase;
  int body;  ///< slot in BodyOwners::here()
  int begin, end, j, k;
  int first;  ///< global x index of the first cell, which determines the lanes of the cells
  int size() const { return end - begin; }
  const double *of(const Field &block, int f) const { return block[f].row(j, k) + begin; }
};

/// Calls visit(run) for all runs of a part, and start(phase, piece of a row) before those of that piece.
template <class Start, class Visit>
void for_each_run(const Box &box, const RowPart &part, const std::vector<Phase> &phases, const BodyOwners &owners,
                  Start &&start, Visit &&visit) {
  const int first = box.layout().begin[0];
  for (const Phase &phase : phases) {
    if (!phase.label) continue;
    const ConstView label = phase.label[0];
    for (const Segment &whole : part.rows(box)) {
      const Segment row = phase.rows.within(whole, label);
      if (row.i_begin < row.i_end) start(phase, row);
      const double *own = label.row(row.j, row.k);
      for (int begin = row.i_begin, end; begin < row.i_end; begin = end) {
        const int block_end = begin + ExactSums::block - ExactSums::index_in_block(first + begin);
        end = begin + 1;
        while (end < std::min(row.i_end, block_end) && own[end] == own[begin]) ++end;
        const int slot = owners.slot(static_cast<int>(own[begin]) - 1);
        if (slot >= 0) visit(Run{phase, slot, begin, end, row.j, row.k, first + begin});
      }
    }
  }
}

/// Sums over the cells of a run: of phi, phi x, phi x^2 (x in cells from a reference), phi u; the number of full cells
/// and the sum of B over them.
struct RunSums {
  double fraction = 0, first_moment = 0, second_moment = 0;
  Real3 momentum{};
  double full_cells = 0;
  std::array<double, 6> tensor{};
};
/// Positions of the cells of a run, in cells from a reference.
struct RunPlaces {
  double x[ExactSums::block];
  double y, z;
};
/// Returns positions relative to the nearest periodic image of the reference cell.
RunPlaces places_of(const Box &box, const Run &run, const Int3 &reference);
/// Sets all sums, for which velocity and B need one ghost layer; without a velocity (null) the first three only.
void sum_run(const Box &box, const Run &run, const RunPlaces &places, const Field *velocity, RunSums *sums);

}  // namespace eulastic
