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

/// The cells of bodies in one phase: those with a label and more than `threshold` of phi.
struct BodyCells {
  static constexpr double threshold = 1e-5;  ///< cells with less are remains, not a body
  ConstView label, fraction;
  /// The label, 0 where no body is.
  double operator()(int i, int j, int k) const noexcept { return fraction(i, j, k) > threshold ? label(i, j, k) : 0; }
};

/// Local: the labels of owned cells and `reach` ghosts, ascending, each once.
std::vector<int> labels_in(const Box &box, ConstView label, int reach = 0);

/// Local: pairs in one phase, body > other, found from owned cells. `reach` ghosts. One pass over the cells, and a
/// closer look only where blocks of reach^3 cells see several labels.
void find_near_in_phase(const Box &box, const BodyCells &cells, int phase, int reach, std::vector<NearBodies> *found);

/// Local: pairs of a body of `labels` (ascending), whose owned cells `own` holds, and any body that `others`, those of
/// another phase, has. `reach` ghosts of both.
void find_near_others(const Box &box, const BodyCells &own, const std::vector<int> &labels, const BodyCells &others,
                      int phase, int reach, std::vector<NearBodies> *found);

}  // namespace eulastic
