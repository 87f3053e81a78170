// Hashes by which the states of runs are compared.
#pragma once

#include "field/phase.hpp"
#include "io/checksum.hpp"

#include <array>
#include <cstdint>
#include <cstring>

namespace eulastic {

inline std::uint64_t bits_of(double value) noexcept {
  std::uint64_t bits;
  std::memcpy(&bits, &value, sizeof bits);
  return bits;
}

/// Hash of the owned points of one field, those on high boundaries included. The sum over fields and ranks (MPI_SUM of
/// uint64) does not depend on the ranks. `salt`: a different number for each field.
std::uint64_t hash_points(const Box &box, ConstView field, const Staggering &staggering, std::uint64_t salt);
/// Hash of one record.
template <std::size_t N>
std::uint64_t hash_values(const std::array<double, N> &values) {
  std::uint64_t hash = 0;
  for (const double value : values) hash = mix_bits(hash ^ mix_bits(bits_of(value)));
  return hash;
}

/// Hash of a body in a box of its own: of phi and B at points that contain a part of it, so that the rest of the box
/// does not matter, and of its markers.
std::uint64_t hash_body(const BodyInBox &body);

}  // namespace eulastic
