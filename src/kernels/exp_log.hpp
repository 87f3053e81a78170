// Branch-free exp and log for simd loops: no libm, explicit fma, the same bits on AVX2 and AVX-512.
//
// exp: x = k ln 2 + r, |r| <= ln 2 / 2, Taylor polynomial of degree 13 in r, scaled by 2^k through the exponent bits.
// log: x = 2^k m, m in [sqrt 1/2, sqrt 2), the series of 2 artanh(f/(2 + f)), f = m - 1, as in fdlibm's e_log.c (Sun,
// 1993). Integers become doubles and back by adding 2^52 constants: AVX2 has no 64-bit conversion.
#pragma once

#include "kernels/isa.hpp"

#include <cstdint>

namespace eulastic::kernels {

inline constexpr double exp_flops = 32, log_flops = 31;

/// e^x for |x| <= 700, to one unit in the last place.
EULASTIC_INLINE double exp(double x) noexcept {
  constexpr double shifter = 0x1.8p52;  // its last bits hold the nearest integer
  const double shifted = fma(x, 1.4426950408889634, shifter);
  const double k = shifted - shifter;
  const double r = fma(k, -1.90821492927058770002e-10, fma(k, -6.93147180369123816490e-01, x));
  double p = 1. / 6227020800;
  p = fma(p, r, 1. / 479001600);
  p = fma(p, r, 1. / 39916800);
  p = fma(p, r, 1. / 3628800);
  p = fma(p, r, 1. / 362880);
  p = fma(p, r, 1. / 40320);
  p = fma(p, r, 1. / 5040);
  p = fma(p, r, 1. / 720);
  p = fma(p, r, 1. / 120);
  p = fma(p, r, 1. / 24);
  p = fma(p, r, 1. / 6);
  p = fma(p, r, 0.5);
  p = fma(p * r, r, r) + 1;
  const std::uint64_t scale = (__builtin_bit_cast(std::uint64_t, shifted) + 1023) << 52;
  return p * __builtin_bit_cast(double, scale);
}

/// ln x for normal x > 0, to one unit in the last place.
EULASTIC_INLINE double log(double x) noexcept {
  constexpr std::uint64_t one = 0x3ff0000000000000, sqrt_half = 0x3fe6a09e667f3bcd, mantissa = 0x000fffffffffffff;
  constexpr std::uint64_t two_52 = 0x4330000000000000;
  const std::uint64_t bits = __builtin_bit_cast(std::uint64_t, x) + (one - sqrt_half);
  const double k = __builtin_bit_cast(double, (bits >> 52) | two_52) - (0x1p52 + 1023);
  const double f = __builtin_bit_cast(double, (bits & mantissa) + sqrt_half) - 1;
  const double s = f / (2 + f), z = s * s, half_square = 0.5 * f * f;
  double p = 1.479819860511658591e-01;
  p = fma(p, z, 1.531383769920937332e-01);
  p = fma(p, z, 1.818357216161805012e-01);
  p = fma(p, z, 2.222219843214978396e-01);
  p = fma(p, z, 2.857142874366239149e-01);
  p = fma(p, z, 3.999999999940941908e-01);
  p = fma(p, z, 6.666666666666735130e-01);
  const double low = fma(s, fma(p, z, half_square), k * 1.90821492927058770002e-10);
  return fma(k, 6.93147180369123816490e-01, f - (half_square - low));
}

}  // namespace eulastic::kernels
