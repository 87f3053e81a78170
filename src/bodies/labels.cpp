#include "bodies/labels.hpp"

#include "base/events.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace eulastic {
namespace {

constexpr int layers = 4;

// While labels spread, those of named cells are positive, old ones not yet confirmed are negative.
struct Candidate {
  double label = 0, phi = 0;
  bool face = false;

  bool better_than(const Candidate &other) const noexcept {
    if ((label > 0) != (other.label > 0)) return label > 0;
    if (face != other.face) return face;
    if (phi != other.phi) return phi > other.phi;
    return std::abs(label) < std::abs(other.label);
  }
};

// The neighbour of local cell c whose label counts, label 0 if there is none. `from`, `to`: cells that exist.
Candidate best_neighbour(const Int3 &c, const Int3 &from, const Int3 &to, ConstView phi, ConstView label) {
  Candidate best;
  for (int k = std::max(c[2] - 1, from[2]); k <= std::min(c[2] + 1, to[2]); ++k)
    for (int j = std::max(c[1] - 1, from[1]); j <= std::min(c[1] + 1, to[1]); ++j)
      for (int i = std::max(c[0] - 1, from[0]); i <= std::min(c[0] + 1, to[0]); ++i) {
        const int steps = std::abs(i - c[0]) + std::abs(j - c[1]) + std::abs(k - c[2]);
        const Candidate other{label(i, j, k), phi(i, j, k), steps == 1};
        if (steps == 0 || other.label == 0) continue;
        if (best.label == 0 || other.better_than(best)) best = other;
      }
  return best;
}

void spread_one_layer(const Grid &grid, ConstView phi, ConstView label, View next) {
  Int3 from{}, to{};
  for (int d = 0; d < 3; ++d) {
    const bool ghosts = grid.layout().ghosts[d] > 0;
    from[d] = ghosts && !grid.touches_low(d) ? -1 : 0;
    to[d] = grid.owned()[d] - (ghosts && !grid.touches_high(d) ? 0 : 1);
  }
  for (const Segment &row : grid.rows())
    for (int i = row.i_begin; i < row.i_end; ++i) {
      const double own = label(i, row.j, row.k);
      next(i, row.j, row.k) = own;
      if (own > 0 || phi(i, row.j, row.k) <= label_threshold) continue;
      const Candidate best = best_neighbour({i, row.j, row.k}, from, to, phi, label);
      if (best.label > 0 || own == 0) next(i, row.j, row.k) = best.label;
    }
}

}  // namespace

PetscErrorCode carry_labels(const Grid &grid, GhostExchange &exchange, FieldBlock work, Phase *phase) {
  static_assert(layers % 2 == 0, "the label ends in its own memory");
  PetscFunctionBeginUser;
  VerbScope scope(Verb::bodies);
  PetscCall(exchange.update(phase->fraction, 1));
  const View phi = phase->fraction[0];
  const auto for_each = [&](auto &&change) {
    const View label = phase->label[0];
    for (const Segment &row : grid.rows())
      for (int i = row.i_begin; i < row.i_end; ++i) change(phi(i, row.j, row.k), label(i, row.j, row.k));
  };
  for_each([](double fraction, double &label) {
    if (fraction <= label_threshold)
      label = 0;
    else if (fraction <= 0.5)
      label = -label;
  });
  for (int layer = 0; layer < layers; ++layer) {
    PetscCall(exchange.update(phase->label, 1));
    spread_one_layer(grid, phi, phase->label[0], work[0]);
    phase->label.swap(work);
  }
  for_each([](double, double &label) { label = std::abs(label); });
  PetscFunctionReturn(0);
}

}  // namespace eulastic
