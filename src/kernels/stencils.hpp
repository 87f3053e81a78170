// Two-point averages along any set of directions, and the velocity that carries a field of any staggering.
#pragma once

#include "kernels/points.hpp"

namespace eulastic::kernels {

/// Sum and mean of q over the 4 points {0, a} x {0, b}.
EULASTIC_INLINE double sum4(const double *q, std::ptrdiff_t a, std::ptrdiff_t b) noexcept {
  return (q[0] + q[a]) + (q[b] + q[a + b]);
}
EULASTIC_INLINE double average4(const double *q, std::ptrdiff_t a, std::ptrdiff_t b) noexcept {
  return 0.25 * sum4(q, a, b);
}

/// Mean of q over the 8 points {0, a} x {0, b} x {0, c}.
EULASTIC_INLINE double average8(const double *q, std::ptrdiff_t a, std::ptrdiff_t b, std::ptrdiff_t c) noexcept {
  return 0.125 * (((q[0] + q[a]) + (q[b] + q[a + b])) + ((q[c] + q[c + a]) + (q[c + b] + q[c + a + b])));
}

/// Face velocity component `d` at the points of a field staggered as `at`, into the slots of `out`.
/// Along each direction where the two locations differ the two neighbours are averaged: towards +d from faces to
/// points that are not staggered in d, towards -e from centres to points that are staggered in e.
template <class Points>
EULASTIC_INLINE void carry_velocity(const Points &points, ConstView face, int d, const bool *at, int dimension,
                                    double *out) noexcept {
  const double *q = face.origin;
  std::ptrdiff_t step[3] = {};
  int steps = 0;
  for (int e = 0; e < dimension; ++e)
    if (at[e] != (e == d)) step[steps++] = e == d ? face.stride(e) : -face.stride(e);
  const std::ptrdiff_t a = step[0], b = step[1], c = step[2];
  switch (steps) {
    case 0:
      for_points(points, face, [=](std::ptrdiff_t o, int i) EULASTIC_BODY { out[i] = q[o]; });
      break;
    case 1:
      for_points(points, face, [=](std::ptrdiff_t o, int i) EULASTIC_BODY { out[i] = 0.5 * (q[o] + q[o + a]); });
      break;
    case 2:
      for_points(points, face, [=](std::ptrdiff_t o, int i) EULASTIC_BODY { out[i] = average4(q + o, a, b); });
      break;
    default:
      for_points(points, face, [=](std::ptrdiff_t o, int i) EULASTIC_BODY { out[i] = average8(q + o, a, b, c); });
  }
}

}  // namespace eulastic::kernels
