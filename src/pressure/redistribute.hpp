// Blocks of cells, one per rank, and the moves between two such distributions: to complete lines, or to fewer ranks.
#pragma once

#include "base/petsc.hpp"
#include "grid/split.hpp"

namespace eulastic {

struct CellBlock {
  Int3 begin{}, cells{};  ///< global; stored x fastest, without ghosts
  bool operator==(const CellBlock &other) const noexcept { return begin == other.begin && cells == other.cells; }
  std::ptrdiff_t size() const noexcept { return std::ptrdiff_t(cells[0]) * cells[1] * cells[2]; }
  std::ptrdiff_t offset(int i, int j, int k) const noexcept {
    return (i - begin[0]) + cells[0] * ((j - begin[1]) + std::ptrdiff_t(cells[1]) * (k - begin[2]));
  }
};

/// The blocks of all ranks.
class CellBlocks {
public:
  explicit CellBlocks(const Split &split);
  /// Complete lines along `direction`: the ranks that shared one now split their cells along `other` instead. So a
  /// move between the two stays among them.
  CellBlocks complete(int direction, int other) const;
  const CellBlock &of(int rank) const { return blocks_[rank]; }
  int ranks() const { return static_cast<int>(blocks_.size()); }
  bool operator==(const CellBlocks &other) const { return blocks_ == other.blocks_; }

private:
  Int3 cells_{}, parts_{};  ///< of the domain; ranks along each direction
  std::vector<Int3> positions_;
  std::vector<CellBlock> blocks_;
};

/// Moves values from one distribution to another and back, one PetscSF for both.
class Redistribution {
public:
  /// Collective. Without effect, and free, when both are the same.
  PetscErrorCode create(MPI_Comm comm, const CellBlocks &from, const CellBlocks &to);
  /// `values` in `from` become `values` in `to`; `other` is scratch. Both must hold the larger of the two blocks.
  PetscErrorCode forward(std::vector<double> &values, std::vector<double> &other);
  PetscErrorCode backward(std::vector<double> &values, std::vector<double> &other);

private:
  SfHandle scatter_;  ///< roots in `from`, leaves in `to`; empty when nothing moves
};

}  // namespace eulastic
