// Averages over two points along any set of directions, and the velocity at the points of a field of any staggering.
#pragma once

#include "kernels/points.hpp"

namespace eulastic::kernels {

/// Returns the minmod of two slopes: the one of smaller size, 0 where their signs differ.
EULASTIC_INLINE double minmod(double near, double far) noexcept {
  const double smaller = __builtin_fabs(near) < __builtin_fabs(far) ? near : far;
  return near * far > 0 ? smaller : 0;
}

/// Sum of q over the 4 points {0, a} x {0, b}.
EULASTIC_INLINE double sum4(const double *q, std::ptrdiff_t a, std::ptrdiff_t b) noexcept {
  return (q[0] + q[a]) + (q[b] + q[a + b]);
}
/// Mean of q over the 4 points {0, a} x {0, b}.
EULASTIC_INLINE double average4(const double *q, std::ptrdiff_t a, std::ptrdiff_t b) noexcept {
  return 0.25 * sum4(q, a, b);
}

/// Mean of q over the 8 points {0, a} x {0, b} x {0, c}.
EULASTIC_INLINE double average8(const double *q, std::ptrdiff_t a, std::ptrdiff_t b, std::ptrdiff_t c) noexcept {
  return 0.125 * (((q[0] + q[a]) + (q[b] + q[a + b])) + ((q[c] + q[c + a]) + (q[c + b] + q[c + a + b])));
}

/// Sum over the 3^d points around q[0], with the same bits for mirrored points.
template <int Dim>
EULASTIC_INLINE double sum_around(const double *q, const std::ptrdiff_t *s) noexcept {
  const auto along_x = [&](std::ptrdiff_t o) EULASTIC_BODY { return (q[o - s[0]] + q[o + s[0]]) + q[o]; };
  const auto along_y = [&](std::ptrdiff_t o)
                           EULASTIC_BODY { return (along_x(o - s[1]) + along_x(o + s[1])) + along_x(o); };
  if constexpr (Dim == 2) return along_y(0);
  return (along_y(-s[2]) + along_y(s[2])) + along_y(0);
}

/// Averages face velocity component `d` to the points of a field staggered as `at`, and writes it to the slots of
/// `out`. Along each direction in which the positions differ the two neighbours are averaged: towards +d from faces to
/// points that are not staggered in d, towards -e from centres to points that are staggered in e.
template <class Points>
EULASTIC_INLINE void average_velocity(const Points &points, ConstView face, int d, const bool *at, int dimension,
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
