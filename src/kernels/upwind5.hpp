// The upwind difference of fifth order: WENO5 with its linear weights.
#pragma once

#include "kernels/stencils.hpp"

namespace eulastic::kernels {

/// Returns h dq/dx at q[0], upwind for the sign of `velocity`, from six of seven points at `stride`. For a negative
/// velocity it is the mirror image.
EULASTIC_INLINE double upwind5_difference(const double *q, std::ptrdiff_t stride, double velocity) noexcept {
  const std::ptrdiff_t s = velocity > 0 ? stride : -stride;
  const double sign = velocity > 0 ? 1. / 60 : -1. / 60;
  const double behind = fma(-2, q[-3 * s], fma(15, q[-2 * s], -60 * q[-s]));
  const double ahead = fma(-3, q[2 * s], fma(30, q[s], 20 * q[0]));
  return sign * (behind + ahead);
}

}  // namespace eulastic::kernels
