#include "pressure/agglomeration.hpp"

#include <algorithm>

namespace eulastic {
namespace {

// Calls copy(offset in the packed values, i, j, k, length) for all rows of a box, with local indices of the field.
template <class F>
void each_row(const CellBlock &box, const Int3 &field_begin, const F &copy) {
  const Int3 first{box.begin[0] - field_begin[0], box.begin[1] - field_begin[1], box.begin[2] - field_begin[2]};
  for (int k = 0; k < box.cells[2]; ++k)
    for (int j = 0; j < box.cells[1]; ++j)
      copy(box.cells[0] * (j + std::ptrdiff_t(box.cells[1]) * k), first[0], first[1] + j, first[2] + k, box.cells[0]);
}

CellBlock owned(const Field &block) { return {block.layout().begin, block.layout().cells}; }

void pack(const Field &block, const CellBlock &box, double *values) {
  each_row(box, block.layout().begin,
           [&](std::ptrdiff_t at, int i, int j, int k, int n) { std::copy_n(block[0].row(j, k) + i, n, values + at); });
}

void unpack(const double *values, const CellBlock &box, Field &block) {
  each_row(box, block.layout().begin,
           [&](std::ptrdiff_t at, int i, int j, int k, int n) { std::copy_n(values + at, n, block[0].row(j, k) + i); });
}

}  // namespace

PetscErrorCode Agglomeration::create(const Partition &from, const Partition &to) {
  PetscFunctionBeginUser;
  from_ = &from;
  to_ = &to;
  values_.resize(static_cast<std::size_t>(std::max(from.box().cell_count(), to.box().cell_count())));
  other_.resize(values_.size());
  if (!everywhere()) {
    PetscCall(redistribution_.create(from.comm(), CellBlocks(from.split()), CellBlocks(to.split())));
    PetscFunctionReturn(0);
  }
  const CellBlocks blocks(from.split());
  int cells = 0;
  for (int rank = 0; rank < from.ranks(); ++rank) {
    const CellBlock &block = blocks.of(rank);
    displacements_.push_back(cells);
    counts_.push_back(static_cast<int>(block.size()));
    cells += counts_.back();
    if (block.size() > 0) blocks_.push_back(block);
  }
  PetscFunctionReturn(0);
}

PetscErrorCode Agglomeration::forward(const Field &from, Field &to) {
  PetscFunctionBeginUser;
  pack(from, owned(from), values_.data());
  if (everywhere()) {
    PetscCallMPI(MPI_Allgatherv(values_.data(), counts_[from_->rank()], MPI_DOUBLE, other_.data(), counts_.data(),
                                displacements_.data(), MPI_DOUBLE, from_->comm()));
    const double *theirs = other_.data();
    for (const CellBlock &block : blocks_) {
      unpack(theirs, block, to);
      theirs += block.size();
    }
  } else {
    PetscCall(redistribution_.forward(values_, other_));
    unpack(values_.data(), owned(to), to);
  }
  PetscFunctionReturn(0);
}

PetscErrorCode Agglomeration::backward(const Field &to, Field &from) {
  PetscFunctionBeginUser;
  const CellBlock mine = owned(from);
  pack(to, everywhere() ? mine : owned(to), values_.data());
  if (!everywhere()) PetscCall(redistribution_.backward(values_, other_));
  unpack(values_.data(), mine, from);
  PetscFunctionReturn(0);
}

}  // namespace eulastic
