// A checksum of stored values that does not depend on who holds which: the sum of a mix of bits and position.
#pragma once

#include <cstdint>
#include <cstring>
#include <string>
#include "base/one_line.hpp"

namespace eulastic {

/// SplitMix64's finaliser (Steele, Lea, Flood 2014).
inline std::uint64_t mix_bits(std::uint64_t x) noexcept {
  x += 0x9e3779b97f4a7c15u;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
  return x ^ (x >> 31);
}

/// Checksum of values[0..count) at positions first, first + 1, ... of a dataset; pieces add up modulo 2^64.
template <class T>
std::uint64_t checksum(const T *values, std::size_t count, std::uint64_t first) noexcept {
  static_assert(sizeof(T) <= sizeof(std::uint64_t), "plain numbers");
  std::uint64_t sum = 0;
  for (std::size_t i = 0; i < count; ++i) {
    std::uint64_t bits = 0;
    std::memcpy(&bits, values + i, sizeof(T));
    sum += mix_bits(bits ^ mix_bits(first + i));
  }
  return sum;
}

/// 16 hexadecimal digits: the attribute `checksum` of a dataset.
inline std::string checksum_text(std::uint64_t sum) { return print("%016llx", static_cast<unsigned long long>(sum)); }

}  // namespace eulastic
