// Branch-free cube root for simd loops: no libm, explicit fma, the same bits on AVX2 and AVX-512.
//
// A third of the upper half of the bits is a root within 4 % (Kahan; fdlibm's s_cbrt.c, Sun, 1993), each step of
// Halley, t <- t (t^3 + 2 x)/(2 t^3 + x), cubes the error. Integers become doubles and back by adding 2^52 constants:
// AVX2 has no 64-bit conversion.
#pragma once

#include "kernels/isa.hpp"

#include <cstdint>

namespace eulastic::kernels {

inline constexpr double cube_root_flops = 17;

/// x^(1/3) for normal x > 0, to 2e-14 of it.
EULASTIC_INLINE double cube_root(double x) noexcept {
  constexpr std::uint64_t two_52 = 0x4330000000000000;
  const double upper = __builtin_bit_cast(double, (__builtin_bit_cast(std::uint64_t, x) >> 32) | two_52) - 0x1p52;
  const double third = fma(upper, 1. / 3, 715094163 + 0x1p52);  // its last bits hold the nearest integer
  double t = __builtin_bit_cast(double, __builtin_bit_cast(std::uint64_t, third) << 32);
  for (int step = 0; step < 2; ++step) {
    const double cube = t * t * t;
    t *= fma(2, x, cube) / fma(2, cube, x);
  }
  return t;
}

}  // namespace eulastic::kernels
