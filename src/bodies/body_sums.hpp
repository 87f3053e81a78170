// Exact sums per body over all ranks: fixed point in 128-bit integers.
#pragma once

#include "field/field_block.hpp"

#include <cstdint>
#include <vector>

namespace eulastic {

/// `per_body` sums for each of `bodies` bodies. Terms are rounded to 2^-48 and may reach 2^30; sums may reach 2^54.
class BodySums {
public:
  BodySums(int bodies, int per_body) : per_body_(per_body), sums_(std::size_t(bodies) * per_body) {}

  void add(int body, int s, double term) noexcept { sums_[std::size_t(body) * per_body_ + s] += fixed(term); }
  /// Sums over all ranks with one Allreduce of two words per sum; for at most 2^23 ranks.
  PetscErrorCode reduce(MPI_Comm comm);
  double value(int body, int s) const noexcept;

private:
  static __int128 fixed(double term) noexcept;

  int per_body_;
  std::vector<__int128> sums_;
};

}  // namespace eulastic
