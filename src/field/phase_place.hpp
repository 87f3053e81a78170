// Where a phase lies: on a rank's part of the grid, or in a box of its own that is whole on this rank.
#pragma once

#include "base/petsc.hpp"
#include "field/ghost_exchange.hpp"
#include "field/sides.hpp"
#include "grid/box.hpp"
#include "grid/occupied_rows.hpp"

namespace eulastic {

struct PhasePlace {
  const Box *box;
  const BoxSides *sides;
  /// Null where the box is whole on this rank: its ghosts are behind sides of the domain, or hold what is far from
  /// bodies.
  GhostExchange *exchange;

  /// Ghosts that other ranks own; `rows` as in WantedGhosts.
  PetscErrorCode exchange_ghosts(Field &field, int width, const OccupiedRows *rows) const;
  /// Ghosts of B from other ranks and behind sides.
  PetscErrorCode update_ghosts(Field &tensor, int width, const OccupiedRows *rows) const;
};

}  // namespace eulastic
