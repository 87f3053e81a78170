// The same cells on other ranks: from all that share a level of the V-cycle to some of them, or to every rank, and
// back.
#pragma once

#include "base/petsc.hpp"
#include "field/field.hpp"
#include "pressure/partition.hpp"
#include "pressure/redistribute.hpp"

namespace eulastic {

class Agglomeration {
public:
  /// Collective. `to` has the same cells: Partition::joined or everywhere. Both must outlive this.
  PetscErrorCode create(const Partition &from, const Partition &to);
  /// Owned values of one field; ghosts are not touched. Collective.
  PetscErrorCode forward(const Field &from, Field &to);
  PetscErrorCode backward(const Field &to, Field &from);

private:
  bool everywhere() const { return to_->ranks() < from_->ranks(); }

  const Partition *from_ = nullptr, *to_ = nullptr;
  Redistribution move_;                      ///< unless everywhere()
  std::vector<double> values_, other_;       ///< blocks, one after the other
  std::vector<CellBlock> blocks_;            ///< everywhere(): of all ranks that have cells, in the order of ranks
  std::vector<int> counts_, displacements_;  ///< everywhere(): of all ranks
};

}  // namespace eulastic
