// Transport of labels with the moving bodies.
//
// Cells with phi > 1/2 keep their label. All others take the label of a labelled neighbour, layer by layer, so that
// labels between two bodies move with them. A layer is updated synchronously, so that neither the loop order nor the
// ranks matter.
#pragma once

#include "base/petsc.hpp"
#include "field/ghost_exchange.hpp"
#include "field/phase.hpp"

namespace eulastic {

inline constexpr double label_threshold = 1e-12;  ///< a cell with less phi has no label

/// Cells that belong to bodies of a phase: those with a label and phi above `threshold`.
struct BodyCells {
  static constexpr double threshold = 1e-5;  ///< smaller phi is residue of the transport, not a body
  ConstView label, fraction;
  /// Returns the label, or 0 where there is no body.
  double operator()(int i, int j, int k) const noexcept { return fraction(i, j, k) > threshold ? label(i, j, k) : 0; }
};

/// Updates phase->label on owned cells and one ghost layer of the fraction. Call it on a schedule that is part of the
/// run, before the interface has moved by more than half a cell since the last call. Four layers are relabelled: a cell
/// prefers a face neighbour to an edge or corner neighbour, then the largest phi, then the smallest label. Beyond four
/// layers a cell keeps its label, if it has one. Collective.
PetscErrorCode carry_labels(const Box &box, GhostExchange &exchange, Phase *phase);
/// Labels only the cells without a label, which the surface has reached since the last call. Collective.
PetscErrorCode label_new_cells(const Box &box, GhostExchange &exchange, Phase *phase);

}  // namespace eulastic
