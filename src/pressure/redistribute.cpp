#include "pressure/redistribute.hpp"

#include <algorithm>
#include <cstdint>

namespace eulastic {

CellBlocks::CellBlocks(const Split &split) {
  for (int d = 0; d < 3; ++d) {
    cells_[d] = split.starts[d].back();
    parts_[d] = split.parts(d);
  }
  for (int rank = 0; rank < parts_[0] * parts_[1] * parts_[2]; ++rank) {
    const Int3 at = split.position_of(rank);
    CellBlock block;
    for (int d = 0; d < 3; ++d) {
      block.begin[d] = split.starts[d][at[d]];
      block.cells[d] = split.cells_along(d, at[d]);
    }
    positions_.push_back(at);
    blocks_.push_back(block);
  }
}

CellBlocks CellBlocks::complete(int direction, int other) const {
  CellBlocks result = *this;
  const std::int64_t parts = parts_[direction];
  for (int rank = 0; rank < ranks(); ++rank) {
    CellBlock &block = result.blocks_[rank];
    Int3 &position = result.positions_[rank];
    const std::int64_t part = position[direction], cells = block.cells[other];
    const int low = static_cast<int>(cells * part / parts), high = static_cast<int>(cells * (part + 1) / parts);
    block.begin[other] += low;
    block.cells[other] = high - low;
    block.begin[direction] = 0;
    block.cells[direction] = cells_[direction];
    position[other] = static_cast<int>(position[other] * parts + part);
    position[direction] = 0;
  }
  result.parts_[other] *= result.parts_[direction];
  result.parts_[direction] = 1;
  return result;
}

PetscErrorCode Redistribution::create(MPI_Comm comm, const CellBlocks &from, const CellBlocks &to) {
  int me;
  PetscFunctionBeginUser;
  if (from == to) PetscFunctionReturn(0);
  PetscCallMPI(MPI_Comm_rank(comm, &me));
  const CellBlock &mine = to.of(me);
  std::vector<PetscSFNode> roots(mine.size());
  for (int rank = 0; rank < from.ranks(); ++rank) {
    const CellBlock &theirs = from.of(rank);
    Int3 low, high;
    for (int d = 0; d < 3; ++d) {
      low[d] = std::max(mine.begin[d], theirs.begin[d]);
      high[d] = std::min(mine.begin[d] + mine.cells[d], theirs.begin[d] + theirs.cells[d]);
    }
    for (int k = low[2]; k < high[2]; ++k)
      for (int j = low[1]; j < high[1]; ++j)
        for (int i = low[0]; i < high[0]; ++i)
          roots[mine.offset(i, j, k)] = {rank, static_cast<PetscInt>(theirs.offset(i, j, k))};
  }
  PetscCall(PetscSFCreate(comm, scatter_.put()));
  PetscCall(PetscSFSetGraph(scatter_.get(), static_cast<PetscInt>(from.of(me).size()),
                            static_cast<PetscInt>(roots.size()), nullptr, PETSC_OWN_POINTER, roots.data(),
                            PETSC_COPY_VALUES));
  PetscCall(PetscSFSetUp(scatter_.get()));
  PetscFunctionReturn(0);
}

PetscErrorCode Redistribution::forward(std::vector<double> &values, std::vector<double> &other) {
  PetscFunctionBeginUser;
  if (!scatter_) PetscFunctionReturn(0);
  PetscCall(PetscSFBcastBegin(scatter_.get(), MPIU_REAL, values.data(), other.data(), MPI_REPLACE));
  PetscCall(PetscSFBcastEnd(scatter_.get(), MPIU_REAL, values.data(), other.data(), MPI_REPLACE));
  values.swap(other);
  PetscFunctionReturn(0);
}

PetscErrorCode Redistribution::backward(std::vector<double> &values, std::vector<double> &other) {
  PetscFunctionBeginUser;
  if (!scatter_) PetscFunctionReturn(0);
  PetscCall(PetscSFReduceBegin(scatter_.get(), MPIU_REAL, values.data(), other.data(), MPI_REPLACE));
  PetscCall(PetscSFReduceEnd(scatter_.get(), MPIU_REAL, values.data(), other.data(), MPI_REPLACE));
  values.swap(other);
  PetscFunctionReturn(0);
}

}  // namespace eulastic
