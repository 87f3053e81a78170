// A branch-free exponential for simd loops, without libm and with explicit fma: the same bits with AVX2 and AVX-512.
//
// x = k ln 2 + r with |r| <= ln 2 / 2; a Taylor polynomial of degree 13 in r is scaled by 2^k through the exponent
// bits. Integers are converted to doubles and back by adding multiples of 2^52, because AVX2 has no 64-bit conversion.
#pragma once

#include "kernels/isa.hpp"

#include <cstdint>

namespace eulastic::kernels {

/// Returns e^x for |x| <= 700, to one unit in the last place.
EULASTIC_INLINE double exp(double x) noexcept {
  constexpr double shifter = 0x1.8p52;  // the last bits of a sum with it hold the nearest integer
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

}  // namespace eulastic::kernels
