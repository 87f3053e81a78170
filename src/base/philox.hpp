// Philox4x32-10, a counter-based random number generator (Salmon, Moraes, Dror & Shaw, SC 2011). A number depends on
// its counter and key alone, so that random events are the same on any number of ranks and after a restart.
#pragma once

#include <array>
#include <cstdint>

namespace eulastic {

using PhiloxCounter = std::array<std::uint32_t, 4>;

/// Returns four random 32-bit numbers after ten rounds.
inline PhiloxCounter philox(PhiloxCounter counter, std::array<std::uint32_t, 2> key) noexcept {
  for (int round = 0; round < 10; ++round) {
    const std::uint64_t a = std::uint64_t{0xD2511F53u} * counter[0], b = std::uint64_t{0xCD9E8D57u} * counter[2];
    counter = {static_cast<std::uint32_t>(b >> 32) ^ counter[1] ^ key[0], static_cast<std::uint32_t>(b),
               static_cast<std::uint32_t>(a >> 32) ^ counter[3] ^ key[1], static_cast<std::uint32_t>(a)};
    key[0] += 0x9E3779B9u;
    key[1] += 0xBB67AE85u;
  }
  return counter;
}

/// Returns a uniformly distributed number in [0, 1) with 53 random bits.
inline double uniform(const PhiloxCounter &random) noexcept {
  const std::uint64_t bits = (std::uint64_t{random[0]} << 32) | random[1];
  return static_cast<double>(bits >> 11) * 0x1p-53;
}

}  // namespace eulastic
