// A phase: bodies of one material that share one solid fraction and one left Cauchy-Green tensor. A species has one
// phase on the grid. If its bodies are stored in boxes of their own (boxes/free_bodies.hpp), each of them is a phase,
// and the phase on the grid is empty.
#pragma once

#include "base/petsc.hpp"
#include "field/boundaries.hpp"
#include "field/carried_tensor.hpp"
#include "field/ghost_exchange.hpp"
#include "field/material.hpp"
#include "field/surface_marker.hpp"
#include "grid/box.hpp"
#include "grid/occupied_rows.hpp"

#include <string>
#include <vector>

namespace eulastic {

/// The state of a phase on this rank.
struct Phase {
  std::string species;  ///< name of the species to which it belongs
  Material material;
  bool boxed = false;    ///< its bodies are stored in boxes of their own
  bool travels = false;  ///< its bodies are rigid and move or rotate through the grid
  Field fraction;        ///< phi, one field at centres, 0 ... 1
  OccupiedRows rows;     ///< rows of phi; the tensor is I outside their spans
  CarriedTensor tensor;  ///< B
  Field label;           ///< label of the body at centres: 0 = none, else 1 + global body index, an exact integer

  /// Bytes of the fields on this rank. Pages of the grid that are never written, as for bodies in boxes, do not count.
  std::size_t bytes() const;
  /// Makes a phase without bodies: phi = 0, B = I, labels (if `labels`) 0, in memory on demand (Field::on_demand).
  void empty(const Box &box, bool labels);
  /// Returns the smallest block of cells that contains all cells with phi > 0. `box` must be complete on this rank.
  Extent extent(const Box &box) const;
  /// Returns the block of extent() extended by `before` and `behind` cells, within `box`; without ghosts.
  Box block(const Box &box, int before, int behind) const;
  /// Returns the smallest part of a row of cells that contains all cells with phi > 0.
  Segment filled(const Segment &row) const;
  /// Copies the fields that the next transport needs.
  void copy_from(const Phase &other);
};

/// Returns the local indices in `box` of the first cell of a block inside it.
Int3 block_offset(const Box &box, const Box &block);

/// A body in a box of its own, which is complete on this rank, as measures access it.
struct BodyInBox {
  int number;   ///< label of the body
  int species;  ///< index of the species
  const Box *box;
  const Phase *phase;                         ///< phase that contains only this body
  const std::vector<SurfaceMarker> *markers;  ///< markers of a membrane
  const Field *velocity = nullptr;            ///< on the faces of the box; null if not needed
};

/// Box, boundaries and ghost exchange of a phase.
struct PhaseDomain {
  const Box *box;
  const BoundaryConditions *sides;
  /// Null if the box is complete on this rank: its ghosts are behind boundaries of the domain, or far from bodies.
  GhostExchange *exchange;

  /// Updates ghosts that other ranks own; `rows` as in GhostUpdate.
  PetscErrorCode exchange_ghosts(Field &field, int width, const OccupiedRows *rows) const;
  /// Updates ghosts of B, from other ranks and behind boundaries.
  PetscErrorCode update_ghosts(Field &tensor, int width, const OccupiedRows *rows) const;
};

}  // namespace eulastic
