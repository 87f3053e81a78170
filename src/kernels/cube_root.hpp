// Branch-free cube root for simd loops, without libm and with explicit fma: the same bits with AVX2 and AVX-512.
//
// A third of the upper half of the bits is the root within 4 % (Kahan; s_cbrt.c of fdlibm, Sun, 1993). Each step of
// Halley's method, t <- t (t^3 + 2 x)/(2 t^3 + x), cubes the error. Integers are converted to doubles and back by
// adding multiples of 2^52, because AVX2 has no 64-bit conversion.
#pragma once

#include "kernels/isa.hpp"

#include <cstdint>

namespace eulastic::kernels {

inline constexpr double cube_root_flops = 17;

/// Returns x^(1/3) for normal x > 0 with a relative error below 2e-14.
EULASTIC_INLINE double cube_root(double x) noexcept {
  constexpr std::uint64_t two_52 = 0x4330000000000000;
  const double upper = __builtin_bit_cast(double, (__builtin_bit_cast(std::uint64_t, x) >> 32) | two_52) - 0x1p52;
  const double third = fma(upper, 1. / 3, 715094163 + 0x1p52);  // the last bits hold the nearest integer
  double t = __builtin_bit_cast(double, __builtin_bit_cast(std::uint64_t, third) << 32);
  for (int step = 0; step < 2; ++step) {
    const double cube = t * t * t;
    t *= fma(2, x, cube) / fma(2, cube, x);
  }
  return t;
}

}  // namespace eulastic::kernels
