// Boxes of cells, one per rank, and the moves between two such partitions: from the grid's own to complete lines, or to
// fewer ranks.
#pragma once

#include "base/petsc.hpp"
#include "grid/domain.hpp"

namespace eulastic {

struct CellBlock {
  Int3 begin{}, cells{};  ///< global; stored x fastest, without ghosts
  bool operator==(const CellBlock &other) const noexcept { return begin == other.begin && cells == other.cells; }
  std::ptrdiff_t size() const noexcept { return std::ptrdiff_t(cells[0]) * cells[1] * cells[2]; }
  std::ptrdiff_t offset(int i, int j, int k) const noexcept {
    return (i - begin[0]) + cells[0] * ((j - begin[1]) + std::ptrdiff_t(cells[1]) * (k - begin[2]));
  }
};

/// Who holds which cells. Known to everybody, without communication.
class Partition {
public:
  /// The grid's own.
  explicit Partition(const Domain &domain);
  /// Complete lines along `direction`: the ranks that shared one now split their cells along `other` instead. So a
  /// move between the two stays among them.
  Partition complete(int direction, int other) const;
  const CellBlock &box(int rank) const { return boxes_[rank]; }
  int ranks() const { return static_cast<int>(boxes_.size()); }
  bool operator==(const Partition &other) const { return boxes_ == other.boxes_; }

private:
  Int3 cells_{}, parts_{};
  std::vector<Int3> positions_;
  std::vector<CellBlock> boxes_;
};

/// Moves the values of one partition to another and back, one PetscSF for both.
class Redistribution {
public:
  /// Collective. Without effect, and free, when both are the same.
  PetscErrorCode create(MPI_Comm comm, const Partition &from, const Partition &to);
  /// `values` in `from` become `values` in `to`; `other` is scratch. Both must hold the larger of the two boxes.
  PetscErrorCode forward(std::vector<double> &values, std::vector<double> &other);
  PetscErrorCode backward(std::vector<double> &values, std::vector<double> &other);

private:
  SfHandle scatter_;  ///< roots in `from`, leaves in `to`; empty when nothing moves
};

}  // namespace eulastic
