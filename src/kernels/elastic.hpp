// Elastic force on the faces of one velocity component, and stress power at a centre, for any law.
//
// Products with off-diagonal components are formed on the edges and then averaged. Then the sum of phi times the stress
// power equals minus the power of the discrete elastic force for any phi (docs/method.md, section 2).
#pragma once

#include "kernels/mooney_rivlin.hpp"
#include "kernels/neo_hookean.hpp"
#include "kernels/solid_shear.hpp"

namespace eulastic::kernels {

/// Calls add(offset, div(sigma)_a) for all points; b and c are the other directions. `viscosity` is SameViscosity or
/// SolidViscosity.
template <int Dim, class Law, class Viscosity, class Points, class Add>
EULASTIC_INLINE void elastic_force(const Points &points, ConstView phi, const double *const *B,
                                   const std::ptrdiff_t *stride, const double *inverse_spacing, int a, const Law &law,
                                   const Viscosity &viscosity, Add add) noexcept {
  const int b = (a + 1) % Dim, c = Dim == 3 ? (a + 2) % 3 : b;
  const double *f = phi.origin, ia = inverse_spacing[a], ib = inverse_spacing[b], ic = inverse_spacing[c];
  const TensorAt<Dim> t = tensor_at<Dim>(B, stride, a, b), other = tensor_at<Dim>(B, stride, a, c);
  const auto shear_stress = [=](const TensorAt<Dim> &edges, double inverse, double third, std::ptrdiff_t i)
                                EULASTIC_BODY {
                                  const Directions d{edges.a, edges.b, edges.c, ia, inverse, third};
                                  return viscosity.template part<Dim>(f + i, d) * law.shear_stress(f, edges, i);
                                };
  for_points(points, phi, [=](std::ptrdiff_t i, int) EULASTIC_BODY {
    double sum = ia * (law.normal_stress(f[i], t, i) - law.normal_stress(f[i - t.a], t, i - t.a));
    sum = fma(ib, shear_stress(t, ib, ic, i + t.b) - shear_stress(t, ib, ic, i), sum);
    if constexpr (Dim == 3) sum = fma(ic, shear_stress(other, ic, ib, i + t.c) - shear_stress(other, ic, ib, i), sum);
    add(i, sum);
  });
}

/// Returns sigma : grad v over phi, with sigma without pressure, at the centre at offset i. `v` points to the
/// velocities on the low faces.
template <int Dim, class Law, class Viscosity>
EULASTIC_INLINE double stress_power(const double *phi, const double *const *B, const double *const *v, std::ptrdiff_t i,
                                    const std::ptrdiff_t *stride, const double *inverse_spacing, const Law &law,
                                    const Viscosity &viscosity) noexcept {
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
      const Directions d{t.a, t.b, t.c, inverse_spacing[a], inverse_spacing[b], inverse_spacing[3 - a - b]};
      double linear = 0, product = 0;
      const auto add_edge = [&](std::ptrdiff_t e) EULASTIC_BODY {
        const double rate = viscosity.template part<Dim>(phi + e, d) * (inverse_spacing[b] * (v[a][e] - v[a][e - t.b]) +
                                                                        inverse_spacing[a] * (v[b][e] - v[b][e - t.a]));
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
