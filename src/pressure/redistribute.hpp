// Distributions of cells as one block per rank, and transfers between two of them: to complete lines, or to fewer
// ranks.
#pragma once

#include "base/petsc.hpp"
#include "grid/split.hpp"

namespace eulastic {

struct CellBlock {
  Int3 begin{}, cells{};  ///< global indices; values are stored with x fastest, without ghosts
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
  /// The distribution with complete lines along `direction`: ranks that shared a line split their cells along `other`
  /// instead, so that the transfer involves only these ranks.
  CellBlocks complete(int direction, int other) const;
  const CellBlock &of(int rank) const { return blocks_[rank]; }
  int ranks() const { return static_cast<int>(blocks_.size()); }
  bool operator==(const CellBlocks &other) const { return blocks_ == other.blocks_; }

private:
  Int3 cells_{}, parts_{};  ///< cells of the domain; ranks along each direction
  std::vector<Int3> positions_;
  std::vector<CellBlock> blocks_;
};

/// Transfers values from one distribution to another and back by one PetscSF.
class Redistribution {
public:
  /// Prepares the transfer. If both distributions are equal, transfers do nothing. Collective.
  PetscErrorCode create(MPI_Comm comm, const CellBlocks &from, const CellBlocks &to);
  /// Transfers `values` from `from` to `to`, or back. `other` is scratch; both vectors must hold the larger of the two
  /// blocks. Collective.
  PetscErrorCode forward(std::vector<double> &values, std::vector<double> &other);
  PetscErrorCode backward(std::vector<double> &values, std::vector<double> &other);

private:
  SfHandle scatter_;  ///< roots in `from`, leaves in `to`; empty if both are equal
};

}  // namespace eulastic
