// A body as it lies in the grid, on every rank, and the same body put down elsewhere.
#pragma once

#include "base/petsc.hpp"
#include "field/ghost_exchange.hpp"
#include "field/phase.hpp"
#include "grid/domain.hpp"

#include <vector>

namespace eulastic {

/// The cells of one body. Of a membrane also those around it, where only its tensor counts.
struct BodyCopy {
  static constexpr int points = 15;  ///< of B at most: three centres, three kinds of edges with four each
  struct Cell {
    Int3 at;                       ///< global, in the box
    double phi;                    ///< negative: only the tensor counts
    std::array<double, points> B;  ///< as for_each_point() goes through them
  };
  int label = 0, phase = -1;  ///< position in the vector of phases
  std::vector<Cell> cells;    ///< in an order that depends on the ranks
};

/// Collective: the bodies with these labels, in their order; without cells where none is left. Owned phi and B count,
/// and one ghost of B.
PetscErrorCode copy_bodies(const Domain &domain, GhostExchange &exchange, const std::vector<int> &labels,
                           std::vector<Phase> *phases, std::vector<BodyCopy> *bodies);

/// Collective: the largest sum, in a cell of `body` moved by `shift` cells, of its phi and what fills the cell already.
PetscErrorCode find_fullest(const Domain &domain, const BodyCopy &body, const Int3 &shift, ConstView filled,
                            double *fullest);

/// Writes owned phi, labels and B of `body`, moved by `shift` cells and called `label`. Ghosts, B around it and rows
/// are the caller's.
void put_body(const Box &box, const BodyCopy &body, const Int3 &shift, int label, Phase *phase);

}  // namespace eulastic
