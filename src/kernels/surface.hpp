// B at a point of a surface: the normal, what the continuity of traction says of the kink of the velocity there, and
// the fading memory of what lies there. docs/method.md, section 7.
//
// K: B <- S B S^T, S = 1 - s t n^T, t = Bn - (n.Bn) n, s = (1 - e^(-(1 - phi) k n.Bn dt))/(n.Bn).
#pragma once

#include "kernels/exp.hpp"
#include "kernels/stencils.hpp"

#include <array>

namespace eulastic::kernels {

template <int Dim>
using Vector = std::array<double, Dim>;
/// Symmetric, all components at one point; in 2-D of the plane.
template <int Dim>
using Tensor = std::array<Vector<Dim>, Dim>;

/// Multiply-adds and the like: of the normal, K and F at a point.
inline constexpr double surface_flops_2d = 190, surface_flops_3d = 560;

template <int Dim>
EULASTIC_INLINE double determinant(const Tensor<Dim> &t) noexcept {
  if constexpr (Dim == 2) return t[0][0] * t[1][1] - t[0][1] * t[0][1];
  return t[0][0] * (t[1][1] * t[2][2] - t[1][2] * t[1][2]) - t[0][1] * (t[0][1] * t[2][2] - t[1][2] * t[0][2]) +
         t[0][2] * (t[0][1] * t[1][2] - t[1][1] * t[0][2]);
}

/// Undivided difference along direction d of q, averaged across the others, at a point that is staggered as `at`: from
/// centres, 1-2-1 across; where it is staggered, the mean of the two beside it.
template <int Dim>
EULASTIC_INLINE double fraction_slope(const double *q, int d, const bool *at, const std::ptrdiff_t *stride) noexcept {
  const auto along = [&](std::ptrdiff_t o) EULASTIC_BODY {
    const std::ptrdiff_t s = stride[d];
    return at[d] ? (q[o] + q[o + s]) - (q[o - s] + q[o - 2 * s]) : q[o + s] - q[o - s];
  };
  const auto across = [](int e, const bool *staggered, const std::ptrdiff_t *strides, std::ptrdiff_t o,
                         const auto &value) EULASTIC_BODY {
    const std::ptrdiff_t s = strides[e];
    return staggered[e] ? fma(3, value(o - s) + value(o), value(o - 2 * s) + value(o + s))
                        : fma(2, value(o), value(o - s) + value(o + s));
  };
  const int e = (d + 1) % Dim;
  if constexpr (Dim == 2) return across(e, at, stride, 0, along);
  const int f = (d + 2) % 3, low = e < f ? e : f, high = e < f ? f : e;
  return across(high, at, stride, 0, [&](std::ptrdiff_t o) EULASTIC_BODY { return across(low, at, stride, o, along); });
}

/// The unit normal; 0 where phi is uniform.
template <int Dim>
EULASTIC_INLINE Vector<Dim> surface_normal(const double *phi, const bool *at, const std::ptrdiff_t *stride,
                                           const double *inverse_spacing) noexcept {
  Vector<Dim> n;
  double square = 0;
  for (int d = 0; d < Dim; ++d) {
    n[d] = inverse_spacing[d] * fraction_slope<Dim>(phi, d, at, stride);
    square = fma(n[d], n[d], square);
  }
  const double scale = square > 0 ? 1 / __builtin_sqrt(square) : 0;
  for (double &component : n) component *= scale;
  return n;
}

/// K at a point: S B S^T, whose determinant is that of B. `strength` = (1 - phi) k dt.
template <int Dim>
EULASTIC_INLINE Tensor<Dim> relax_traction(const Tensor<Dim> &B, const Vector<Dim> &n, double strength) noexcept {
  Vector<Dim> Bn{}, t;
  double across = 0;
  for (int a = 0; a < Dim; ++a) {
    for (int b = 0; b < Dim; ++b) Bn[a] = fma(B[a][b], n[b], Bn[a]);
    across = fma(n[a], Bn[a], across);
  }
  if (!(across > 0)) return B;
  const double rate = strength * across, s = (1 - exp(rate < 700 ? -rate : -700)) / across;
  for (int a = 0; a < Dim; ++a) t[a] = fma(-across, n[a], Bn[a]);
  Tensor<Dim> next;
  for (int a = 0; a < Dim; ++a)
    for (int b = a; b < Dim; ++b)
      next[a][b] = next[b][a] = fma(s * s * across * t[a], t[b], B[a][b] - s * (t[a] * Bn[b] + Bn[a] * t[b]));
  return next;
}

/// 2 D:D of the velocity's gradient D, symmetrised.
template <int Dim>
EULASTIC_INLINE double double_contraction(const Tensor<Dim> &D) noexcept {
  double sum = 0;
  for (int a = 0; a < Dim; ++a) {
    sum = fma(2 * D[a][a], D[a][a], sum);
    for (int b = a + 1; b < Dim; ++b) sum = fma(4 * D[a][b], D[a][b], sum);
  }
  return sum;
}

}  // namespace eulastic::kernels
