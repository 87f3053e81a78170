// Copies of bodies on the grid, and their insertion elsewhere.
#pragma once

#include "base/petsc.hpp"
#include "field/ghost_exchange.hpp"
#include "field/phase.hpp"
#include "grid/domain.hpp"

#include <vector>

namespace eulastic {

/// The cells of one body; for a membrane also cells around it, of which only the tensor is used.
struct BodyCopy {
  static constexpr int points = 15;  ///< of B at most: three centres, three kinds of edges with four each
  struct Cell {
    Int3 at;                       ///< global index
    double phi;                    ///< negative: only the tensor is used
    std::array<double, points> B;  ///< in the order of for_each_point()
  };
  int label = 0, phase = -1;  ///< position in the vector of phases
  std::vector<Cell> cells;    ///< in an order that depends on the ranks
};

/// Copies the bodies with these labels, in their order, to all ranks; a body that does not exist has no cells. Reads
/// owned phi and B, and one ghost of B. Collective.
PetscErrorCode copy_bodies(const Domain &domain, GhostExchange &exchange, const std::vector<int> &labels,
                           std::vector<Phase> *phases, std::vector<BodyCopy> *bodies);

/// Returns in `fullest` the largest sum of phi of `body`, moved by `shift` cells, and `filled` in any cell. Collective.
PetscErrorCode find_fullest(const Domain &domain, const BodyCopy &body, const Int3 &shift, ConstView filled,
                            double *fullest);

/// Writes owned phi, labels and B of `body`, moved by `shift` cells, with the given label. Ghosts, B around the body
/// and rows are left to the caller.
void insert_body(const Box &box, const BodyCopy &body, const Int3 &shift, int label, Phase *phase);

}  // namespace eulastic
