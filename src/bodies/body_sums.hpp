// Exact sums per body over all ranks, in 128-bit fixed point: the bits do not depend on the order.
#pragma once

#include "base/petsc.hpp"
#include "bodies/body_owners.hpp"

#include <cmath>
#include <vector>

namespace eulastic {

/// Holds `per_body` sums for each of `bodies` bodies. Terms are rounded to 2^-48; terms up to 2^40 and sums up to 2^54
/// are exact.
class BodySums {
public:
  BodySums(std::size_t bodies, int per_body) : per_body_(per_body), sums_(bodies * per_body) {}

  void add(int body, int s, double term) noexcept { sums_[std::size_t(body) * per_body_ + s] += fixed(term); }
  /// Adds the sums of `other`, which has the same size.
  void add(const BodySums &other) noexcept;
  /// Replaces this rank's partial sums of the bodies owners.here() by the sums over all ranks of the bodies that this
  /// rank owns. At most 2^19 ranks. Collective.
  PetscErrorCode reduce(const BodyOwners &owners);
  double value(int body, int s) const noexcept;

private:
  static __int128 fixed(double term) noexcept {
    if (!(std::abs(term) <= 0x1p40)) term = 0x1p40;  // a diverged run, which other checks report; avoids overflow
    const double scaled = term * 0x1p48;
    // Above 2^53 a double is an integer already.
    return std::abs(scaled) < 0x1p53 ? static_cast<__int128>(std::llrint(scaled)) : static_cast<__int128>(scaled);
  }

  int per_body_;
  std::vector<__int128> sums_;
};

}  // namespace eulastic
