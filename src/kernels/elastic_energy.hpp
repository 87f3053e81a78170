// Strain energy and stress power at a centre, per solid fraction, of any law.
//
// Products with off-diagonal components are formed on their edges and then averaged: summed up, phi times the stress
// power is minus the power of the discrete elastic force, whatever phi is (docs/method.md).
#pragma once

#include "kernels/mooney_rivlin.hpp"

namespace eulastic::kernels {

/// Block position of component (x, y), see tensor_components().
template <int Dim>
constexpr int position(int x, int y) {
  return x == y ? x : Dim == 2 ? 2 : 6 - x - y;
}

/// B seen from directions a and b; `B` points to the components in their order.
template <int Dim>
EULASTIC_INLINE TensorAt tensor_at(const double *const *B, const std::ptrdiff_t *stride, int a, int b) noexcept {
  if (Dim == 2) return {B[a], B[b], B[a], B[2], B[2], B[2], stride[a], stride[b], 0};
  const int c = 3 - a - b;
  return {B[a],      B[b],      B[c],     B[position<Dim>(a, b)], B[position<Dim>(a, c)], B[position<Dim>(b, c)],
          stride[a], stride[b], stride[c]};
}

/// W = c1 (I - 3) + c2 (II - 3) + c3 (I - 3)^2 at the centre at offset i; the second term if WithSecond.
template <int Dim, bool WithSecond>
EULASTIC_INLINE double energy_density(const double *const *B, std::ptrdiff_t i, const std::ptrdiff_t *stride,
                                      const MooneyRivlin &m) noexcept {
  const TensorAt t = tensor_at<Dim>(B, stride, 0, 1);
  const double *aa = t.aa + i, *bb = t.bb + i, *cc = t.cc + i;
  const double excess = excess_trace<Dim>(aa, bb, cc);
  const double energy = 0.5 * m.k1 * excess + 0.25 * m.k3 * excess * excess;
  if (!WithSecond) return energy;
  double second = minor(aa, bb, t.ab + i, t.a, t.b) - 1;
  if (Dim == 3)
    second += (minor(aa, cc, t.ac + i, t.a, t.c) - 1) + (minor(bb, cc, t.bc + i, t.b, t.c) - 1);
  else
    second += (*aa - 1) + (*bb - 1);
  return energy + 0.5 * m.k2 * second;
}

/// sigma : grad v, sigma without its pressure, at the centre at offset i; `v` points to the velocities on the low
/// faces.
template <int Dim>
EULASTIC_INLINE double power_density(const double *const *B, const double *const *v, std::ptrdiff_t i,
                                     const std::ptrdiff_t *stride, const double *inverse_spacing,
                                     const MooneyRivlin &m) noexcept {
  double power = 0;
#pragma GCC unroll 3
  for (int a = 0; a < Dim; ++a)
    power += mooney_rivlin_normal<Dim>(tensor_at<Dim>(B, stride, a, (a + 1) % Dim), i, m) *
             (inverse_spacing[a] * (v[a][i + stride[a]] - v[a][i]));
#pragma GCC unroll 3
  for (int a = 0; a < Dim; ++a)
#pragma GCC unroll 3
    for (int b = a + 1; b < Dim; ++b) {
      const TensorAt t = tensor_at<Dim>(B, stride, a, b);
      double linear = 0, product = 0;
      const auto add_edge = [&](std::ptrdiff_t e) EULASTIC_BODY {
        const double rate =
            inverse_spacing[b] * (v[a][e] - v[a][e - t.b]) + inverse_spacing[a] * (v[b][e] - v[b][e - t.a]);
        linear += t.ab[e] * rate;
        if (Dim == 3) product += vertex_product(t.ac + e, t.bc + e, t.a, t.b, t.c) * rate;
      };
      add_edge(i);
      add_edge(i + t.a);
      add_edge(i + t.b);
      add_edge(i + t.a + t.b);
      power += 0.25 * (shear_factor<Dim>(t.aa + i, t.bb + i, t.cc + i, m) * linear - m.k2 * product);
    }
  return power;
}

}  // namespace eulastic::kernels
