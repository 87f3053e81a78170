// Exact sums per body over all ranks: fixed point in 128-bit integers.
#pragma once

#include "base/petsc.hpp"
#include "bodies/body_owners.hpp"

#include <cmath>
#include <vector>

namespace eulastic {

/// `per_body` sums for each of `bodies` bodies. Terms are rounded to 2^-48 and may reach 2^40; sums may reach 2^54.
class BodySums {
public:
  BodySums(std::size_t bodies, int per_body) : per_body_(per_body), sums_(bodies * per_body) {}

  void add(int body, int s, double term) noexcept { sums_[std::size_t(body) * per_body_ + s] += fixed(term); }
  /// Adds the sums of `other`, of as many.
  void add(const BodySums &other) noexcept;
  /// From those of the bodies that `owners` has here to the sums over all ranks of those it owns; for at most 2^19
  /// ranks. Collective.
  PetscErrorCode reduce(const BodyOwners &owners);
  double value(int body, int s) const noexcept;

private:
  static __int128 fixed(double term) noexcept {
    if (!(std::abs(term) <= 0x1p40)) term = 0x1p40;  // a run that has gone wrong: others say so, here nothing overflows
    const double scaled = term * 0x1p48;
    // Above 2^53 a double is an integer already.
    return std::abs(scaled) < 0x1p53 ? static_cast<__int128>(std::llrint(scaled)) : static_cast<__int128>(scaled);
  }

  int per_body_;
  std::vector<__int128> sums_;
};

}  // namespace eulastic
