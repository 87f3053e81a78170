// Transfer of the cells of a multigrid level from all ranks that share it to some of them, or to every rank, and back.
#pragma once

#include "base/petsc.hpp"
#include "field/field.hpp"
#include "pressure/partition.hpp"
#include "pressure/redistribute.hpp"

namespace eulastic {

class Agglomeration {
public:
  /// Prepares the transfer. `to` has the same cells: Partition::joined() or everywhere(). Both must outlive this.
  /// Collective.
  PetscErrorCode create(const Partition &from, const Partition &to);
  /// Transfers the owned values of one field. Ghosts are not changed. Collective.
  PetscErrorCode forward(const Field &from, Field &to);
  PetscErrorCode backward(const Field &to, Field &from);

private:
  bool everywhere() const { return to_->ranks() < from_->ranks(); }

  const Partition *from_ = nullptr, *to_ = nullptr;
  Redistribution redistribution_;            ///< not used if everywhere()
  std::vector<double> values_, other_;       ///< packed blocks
  std::vector<CellBlock> blocks_;            ///< if everywhere(): blocks of all ranks with cells, in the order of ranks
  std::vector<int> counts_, displacements_;  ///< if everywhere(): of all ranks
};

}  // namespace eulastic
