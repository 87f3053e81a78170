// Distribution of the cells of a multigrid level over the ranks. Unlike with a DMDA, ranks may have no cells.
#pragma once

#include "field/ghost_exchange.hpp"
#include "grid/domain.hpp"

namespace eulastic {

/// Boundaries of the domain, [direction][low, high], where the solution is 0; on the others its normal derivative is.
using ZeroSides = std::array<std::array<bool, 2>, 3>;

class Partition {
public:
  /// The distribution of the domain's DMDA.
  explicit Partition(const Domain &domain) : Partition(domain, domain.domain_shape().open) {}
  /// The same, with open boundaries where the solution is 0.
  Partition(const Domain &domain, const ZeroSides &zero);
  /// The domain with fewer cells. In a direction with fewer cells the first cell of each rank is half of the former
  /// one, rounded up.
  Partition coarse(const Int3 &cells) const;
  /// The same cells on fewer ranks: in the given directions every second rank with cells also takes those of the next
  /// one.
  Partition joined(const std::array<bool, 3> &along) const;
  /// The same cells, all of them on every rank.
  Partition everywhere() const;

  MPI_Comm comm() const { return comm_; }
  int rank() const { return rank_; }
  int ranks() const { return ranks_; }
  const Split &split() const { return split_; }
  /// The cells of this rank.
  const Box &box() const { return box_; }
  /// The ghosts of this rank and their owners.
  std::vector<Ghost> ghosts() const;

private:
  /// Sets the box to the part of this rank in a domain of `cells`, divided by split_.
  void set_box(DomainShape shape, const Int3 &cells);

  MPI_Comm comm_;
  int rank_, ranks_;
  Split split_;
  Box box_;
};

}  // namespace eulastic
