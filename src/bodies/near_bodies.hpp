// Which bodies lie within some cells of each other, found on the grid from their labels.
#pragma once

#include "field/phase.hpp"

namespace eulastic {

/// Two bodies near each other; `phase` is that of `other`, a position in the vector of phases.
struct NearBodies {
  int body, other, phase;
  bool operator<(const NearBodies &b) const noexcept {
    return body != b.body ? body < b.body : other != b.other ? other < b.other : phase < b.phase;
  }
  bool operator==(const NearBodies &b) const noexcept { return body == b.body && other == b.other && phase == b.phase; }
};

/// Local: pairs in one phase, body > other, found from owned cells. `reach` ghosts of the label. One pass over the
/// cells, and a closer look only where blocks of reach^3 cells see several labels.
void find_near_in_phase(const Grid &grid, ConstView label, int phase, int reach, std::vector<NearBodies> *found);

/// Local: pairs of a body of `labels` (ascending), whose owned cells `own` holds, and any body that `others`, the
/// label of another phase, has. `reach` ghosts of both.
void find_near_others(const Grid &grid, ConstView own, const std::vector<int> &labels, ConstView others, int phase,
                      int reach, std::vector<NearBodies> *found);

/// Collective: the pairs of all ranks, each once, ascending.
PetscErrorCode gather_near(MPI_Comm comm, std::vector<NearBodies> *found);

}  // namespace eulastic
