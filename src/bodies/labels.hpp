// Labels follow the moving bodies.
//
// Cells with phi > 1/2 keep their label: they name the body. All others take the label of a named neighbour, layer
// by layer, so that the labels between two bodies move with them. Synchronous, hence free of sweep order and ranks.
#pragma once

#include "base/petsc.hpp"
#include "field/ghost_exchange.hpp"
#include "field/phase.hpp"

namespace eulastic {

inline constexpr double label_threshold = 1e-12;  ///< a cell with less phi has no label

/// The cells of bodies in one phase: those with a label and more than `threshold` of phi.
struct BodyCells {
  static constexpr double threshold = 1e-5;  ///< cells with less are remains, not a body
  ConstView label, fraction;
  /// The label, 0 where no body is.
  double operator()(int i, int j, int k) const noexcept { return fraction(i, j, k) > threshold ? label(i, j, k) : 0; }
};

/// Updates phase->label on owned cells (and one ghost layer of fraction); to be called, on a schedule that is part of
/// the run, before the interface has moved by more than half a cell since the last call. Layers taken anew: four. A
/// cell takes the label of a face neighbour before that of an edge or corner neighbour, then of the one with the
/// largest phi, then the smallest label; beyond four layers it keeps its own, if it has one.
PetscErrorCode carry_labels(const Box &box, GhostExchange &exchange, Phase *phase);
/// The same for cells alone that have no label yet, which the surface has reached since.
PetscErrorCode label_new_cells(const Box &box, GhostExchange &exchange, Phase *phase);

}  // namespace eulastic
