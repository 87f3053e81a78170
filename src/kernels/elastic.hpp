// Elastic force at the faces of one velocity component and stress power at a centre, of any law.
//
// Products with off-diagonal components are formed on their edges and then averaged: summed up, phi times the stress
// power is minus the power of the discrete elastic force, whatever phi is (docs/method.md).
#pragma once

#include "kernels/mooney_rivlin.hpp"
#include "kernels/neo_hookean.hpp"

namespace eulastic::kernels {

/// add(offset, div(sigma)_a) for all points; b, c: the other directions.
template <int Dim, class Law, class Points, class Add>
EULASTIC_INLINE void elastic_force(const Points &points, ConstView phi, const double *const *B,
                                   const std::ptrdiff_t *stride, const double *inverse_spacing, int a, const Law &law,
                                   Add add) noexcept {
  const int b = (a + 1) % Dim, c = Dim == 3 ? (a + 2) % 3 : b;
  const double *f = phi.origin, ia = inverse_spacing[a], ib = inverse_spacing[b], ic = inverse_spacing[c];
  const TensorAt<Dim> t = tensor_at<Dim>(B, stride, a, b), other = tensor_at<Dim>(B, stride, a, c);
  for_points(points, phi, [=](std::ptrdiff_t i, int) EULASTIC_BODY {
    double sum = ia * (law.normal_stress(f[i], t, i) - law.normal_stress(f[i - t.a], t, i - t.a));
    sum = fma(ib, law.shear_stress(f, t, i + t.b) - law.shear_stress(f, t, i), sum);
    if constexpr (Dim == 3) sum = fma(ic, law.shear_stress(f, other, i + t.c) - law.shear_stress(f, other, i), sum);
    add(i, sum);
  });
}

/// sigma : grad v per phi, sigma without its pressure, at the centre at offset i; `v` points to the velocities on the
/// low faces.
template <int Dim, class Law>
EULASTIC_INLINE double stress_power(const double *const *B, const double *const *v, std::ptrdiff_t i,
                                    const std::ptrdiff_t *stride, const double *inverse_spacing,
                                    const Law &law) noexcept {
  double power = 0;
#pragma GCC unroll 3
  for (int a = 0; a < Dim; ++a)
    power += law.normal_stress(1, tensor_at<Dim>(B, stride, a, (a + 1) % Dim), i) *
             (inverse_spacing[a] * (v[a][i + stride[a]] - v[a][i]));
#pragma GCC unroll 3
  for (int a = 0; a < Dim; ++a)
#pragma GCC unroll 3
    for (int b = a + 1; b < Dim; ++b) {
      const TensorAt<Dim> t = tensor_at<Dim>(B, stride, a, b);
      double linear = 0, product = 0;
      const auto add_edge = [&](std::ptrdiff_t e) EULASTIC_BODY {
        const double rate =
            inverse_spacing[b] * (v[a][e] - v[a][e - t.b]) + inverse_spacing[a] * (v[b][e] - v[b][e - t.a]);
        linear += t.ab[e] * rate;
        if constexpr (Dim == 3 && Law::couples_edges) product += vertex_product(t, e) * rate;
      };
      add_edge(i);
      add_edge(i + t.a);
      add_edge(i + t.b);
      add_edge(i + t.a + t.b);
      double sum = law.shear_factor(t, i) * linear;
      if constexpr (Dim == 3 && Law::couples_edges) sum -= law.k2 * product;
      power += 0.25 * sum;
    }
  return power;
}

}  // namespace eulastic::kernels
