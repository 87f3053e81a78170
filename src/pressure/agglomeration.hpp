// The same cells on other ranks: from all that share a level of the V-cycle to some of them, or to every rank, and
// back.
#pragma once

#include "field/field_block.hpp"
#include "pressure/redistribute.hpp"

namespace eulastic {

class Agglomeration {
public:
  /// Collective. `to` is one of the same cells: Grid::joined, or with all of them on every rank. Both must stay.
  PetscErrorCode create(const Grid &from, const Grid &to);
  /// Owned values of one field; ghosts are not touched. Collective.
  PetscErrorCode forward(const FieldBlock &from, FieldBlock &to);
  PetscErrorCode backward(const FieldBlock &to, FieldBlock &from);

private:
  bool everywhere() const { return to_->ranks() < from_->ranks(); }

  const Grid *from_ = nullptr, *to_ = nullptr;
  Redistribution move_;                      ///< unless everywhere()
  std::vector<double> values_, other_;       ///< boxes, one after the other
  std::vector<Box> boxes_;                   ///< everywhere(): of all ranks that have cells, in the order of ranks
  std::vector<int> counts_, displacements_;  ///< everywhere(): of all ranks
};

}  // namespace eulastic
