// Random numbers that depend on the seed only, so that all ranks draw the same.
#pragma once

#include "grid/box.hpp"

#include <cmath>
#include <cstdint>
#include <string>

namespace eulastic {

/// SplitMix64 (Steele, Lea and Flood, OOPSLA 2014).
class Random {
public:
  /// Different names have independent streams for the same seed.
  Random(long seed, const std::string &name) : state_(static_cast<std::uint64_t>(seed)) {
    for (const char c : name) state_ = mix(state_ + static_cast<unsigned char>(c));
  }

  std::uint64_t bits() noexcept { return mix(state_ += 0x9e3779b97f4a7c15u); }
  /// Uniform in [low, high).
  double between(double low, double high) noexcept {
    return low + (high - low) * (static_cast<double>(bits() >> 11) * 0x1p-53);
  }
  /// Uniform in 0 ... n - 1; n > 0.
  std::uint64_t below(std::uint64_t n) noexcept { return bits() % n; }
  /// Angles about x, then y, then z in degrees, uniform over all orientations; in 2-D about z only.
  Real3 orientation(int dimension) noexcept {
    const double z = between(-180, 180);
    if (dimension == 2) return {0, 0, z};
    const double y = std::asin(between(-1, 1)) * (180 / 3.14159265358979323846);
    return {between(-180, 180), y, z};
  }

private:
  static std::uint64_t mix(std::uint64_t x) noexcept {
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
    x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
    return x ^ (x >> 31);
  }
  std::uint64_t state_;
};

}  // namespace eulastic
