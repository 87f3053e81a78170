// Which cells each rank has of a level of the V-cycle. Ranks may have none, as a DMDA does not allow.
#pragma once

#include "field/ghost_exchange.hpp"
#include "grid/domain.hpp"

namespace eulastic {

/// Boundaries of the domain, [direction][low, high], where the solution is 0; on the others its normal derivative is.
using ZeroSides = std::array<std::array<bool, 2>, 3>;

class Partition {
public:
  /// That of the domain's DMDA.
  explicit Partition(const Domain &domain) : Partition(domain, domain.domain_shape().open) {}
  /// The same, with open boundaries where the solution is 0.
  Partition(const Domain &domain, const ZeroSides &zero);
  /// The domain in fewer cells. In a direction with fewer cells each rank begins at half of its first cell, rounded up.
  Partition coarse(const Int3 &cells) const;
  /// The same cells on fewer ranks: in each named direction every second rank that has cells takes those of the next
  /// one as well.
  Partition joined(const std::array<bool, 3> &along) const;
  /// The same cells, all of them on every rank.
  Partition everywhere() const;

  MPI_Comm comm() const { return comm_; }
  int rank() const { return rank_; }
  int ranks() const { return ranks_; }
  const Split &split() const { return split_; }
  /// The cells of this rank.
  const Box &box() const { return box_; }
  /// The ghosts of this rank.
  std::vector<Ghost> ghosts() const;

private:
  /// `cells` of a domain, divided by split_.
  void set_box(DomainShape shape, const Int3 &cells);

  MPI_Comm comm_;
  int rank_, ranks_;
  Split split_;
  Box box_;
};

}  // namespace eulastic
