// The cells of each rank: a tensor product of splits of the directions. Ranks are numbered along x first.
#pragma once

#include "grid/box.hpp"

#include <algorithm>

namespace eulastic {

/// Returns the largest power of two that divides `cells` and at which cuts cause an imbalance of at most one eighth.
/// With cuts at its multiples, coarse grids have whole cells on every rank.
inline int cut_unit(int cells, int parts) {
  int unit = 1;
  while (cells % (2 * unit) == 0 && cells / parts >= 8 * 2 * unit) unit *= 2;
  return unit;
}

/// The decomposition of the cells of the domain.
struct Split {
  std::array<std::vector<int>, 3> starts;  ///< [direction][position]: first cell; the number of cells at the end

  /// Number of ranks along direction d.
  int parts(int d) const { return static_cast<int>(starts[d].size()) - 1; }
  /// Number of cells along d of the ranks at a position.
  int cells_along(int d, int position) const { return starts[d][position + 1] - starts[d][position]; }
  /// Position along d of the ranks that own index i. Index N belongs to the owner of N - 1.
  int position_along(int d, int i) const {
    const int cell = std::min(i, starts[d].back() - 1);
    return static_cast<int>(std::upper_bound(starts[d].begin(), starts[d].end(), cell) - starts[d].begin()) - 1;
  }

  Int3 position_of(int rank) const { return {rank % parts(0), rank / parts(0) % parts(1), rank / parts(0) / parts(1)}; }
  int rank_at(const Int3 &position) const { return position[0] + parts(0) * (position[1] + parts(1) * position[2]); }
  /// The block of cells of a rank, as a part of `domain`.
  Box box_of(int rank, const DomainShape &domain, int ghosts) const {
    const Int3 at = position_of(rank);
    return {domain,
            {starts[0][at[0]], starts[1][at[1]], starts[2][at[2]]},
            {cells_along(0, at[0]), cells_along(1, at[1]), cells_along(2, at[2])},
            ghosts,
            parts(0) == 1};
  }
};

}  // namespace eulastic
