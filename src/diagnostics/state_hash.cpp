#include "diagnostics/state_hash.hpp"

#include <cstring>

namespace eulastic {
namespace {

std::uint64_t bits_of(double value) noexcept {
  std::uint64_t bits;
  std::memcpy(&bits, &value, sizeof bits);
  return bits;
}

// SplitMix64's finaliser (Steele, Lea, Flood 2014).
std::uint64_t mix(std::uint64_t x) noexcept {
  x += 0x9e3779b97f4a7c15u;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
  return x ^ (x >> 31);
}

}  // namespace

std::uint64_t hash_points(const Box &box, ConstView field, const Staggering &staggering, std::uint64_t salt) {
  const Layout &own = box.layout();
  std::uint64_t hash = 0;
  for (int k = 0; k < box.points_end(2, staggering[2]); ++k)
    for (int j = 0; j < box.points_end(1, staggering[1]); ++j) {
      const double *row = field.row(j, k);
      const std::uint64_t y = own.begin[1] + j, z = own.begin[2] + k;
      const std::uint64_t row_key = mix(salt ^ mix(y + (z << 32)));
      for (int i = 0; i < box.points_end(0, staggering[0]); ++i)
        hash += mix(bits_of(row[i]) ^ mix(row_key + own.begin[0] + i));
    }
  return hash;
}

std::uint64_t hash_values(const double *values, std::size_t count) {
  std::uint64_t hash = 0;
  for (std::size_t n = 0; n < count; ++n) hash = mix(hash ^ mix(bits_of(values[n])));
  return hash;
}

}  // namespace eulastic
