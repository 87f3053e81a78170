// A phase: bodies of one material that share one solid fraction and one left Cauchy-Green tensor. A species has one on
// the grid. Where its bodies lie in boxes of their own (boxes/free_bodies.hpp), each of them is a phase, and that of
// the species is empty.
#pragma once

#include "base/petsc.hpp"
#include "field/carried_tensor.hpp"
#include "field/ghost_exchange.hpp"
#include "field/material.hpp"
#include "field/sides.hpp"
#include "field/surface_marker.hpp"
#include "grid/box.hpp"
#include "grid/occupied_rows.hpp"

#include <string>
#include <vector>

namespace eulastic {

struct Phase {
  std::string species;  ///< name of the species it belongs to
  Material material;
  bool boxed = false;    ///< its bodies lie in boxes of their own
  bool travels = false;  ///< its bodies are rigid, and go through the grid or turn in it
  Field fraction;        ///< phi, one centred field, 0 ... 1
  OccupiedRows rows;     ///< of phi; once they are known the tensor is I in all others
  CarriedTensor tensor;  ///< B
  Field label;           ///< body label at centres, 0 = none, else 1 + global body index; held as double, exact

  /// Of what it has on this rank; nobody writes to the grid for bodies in boxes, nor to B that is not carried.
  std::size_t bytes() const;
  /// No body: phi = 0, B = I, labels (where wanted) 0, in memory that follows the bodies (Field::at_rest).
  void empty(const Box &box, bool labels);
  /// The least block of cells that has all in which phi is not 0; `box`: whole on this rank.
  Extent extent(const Box &box) const;
  /// The cells of extent() with so many before and behind them, as far as `box` has them; without ghosts.
  Box block(const Box &box, int before, int behind) const;
  /// Of a row of cells, the least that has all in which phi is not 0.
  Segment filled(const Segment &row) const;
  /// What transport() needs to go on from there.
  void copy_from(const Phase &other);
};

/// Local indices in `box` of the first cell of a block that lies in it.
Int3 first_in(const Box &box, const Box &block);

/// A body in a box of its own, which is whole on this rank, as those see it who measure.
struct BodyInBox {
  int number;   ///< its label
  int species;  ///< index
  const Box *box;
  const Phase *phase;                         ///< of this body alone
  const std::vector<SurfaceMarker> *markers;  ///< of a membrane
  const Field *velocity = nullptr;            ///< on the faces of the box, where it is wanted
};

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
