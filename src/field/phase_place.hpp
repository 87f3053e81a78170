// The domain of a phase: this rank's part of the grid, or a box of its own that is complete on this rank.
#pragma once

#include "base/petsc.hpp"
#include "field/ghost_exchange.hpp"
#include "field/sides.hpp"
#include "grid/box.hpp"
#include "grid/occupied_rows.hpp"

namespace eulastic {

/// Box, boundaries and ghost exchange of a phase.
struct PhasePlace {
  const Box *box;
  const BoxSides *sides;
  /// Null if the box is complete on this rank: its ghosts are behind boundaries of the domain, or far from bodies.
  GhostExchange *exchange;

  /// Updates ghosts that other ranks own; `rows` as in WantedGhosts.
  PetscErrorCode exchange_ghosts(Field &field, int width, const OccupiedRows *rows) const;
  /// Updates ghosts of B, from other ranks and behind boundaries.
  PetscErrorCode update_ghosts(Field &tensor, int width, const OccupiedRows *rows) const;
};

}  // namespace eulastic
