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
inline TensorAt tensor_at(const double *const *B, const std::ptrdiff_t *stride, int a, int b) noexcept {
  if (Dim == 2) return {B[a], B[b], B[a], B[2], B[2], B[2], stride[a], stride[b], 0};
  const int c = 3 - a - b;
  return {B[a],      B[b],      B[c],     B[position<Dim>(a, b)], B[position<Dim>(a, c)], B[position<Dim>(b, c)],
          stride[a], stride[b], stride[c]};
}

/// W = c1 (I - 3) + c2 (II - 3) + c3 (I - 3)^2.
template <int Dim>
inline double energy_density(const double *const *B, const std::ptrdiff_t *stride, const MooneyRivlin &m) noexcept {
  const TensorAt t = tensor_at<Dim>(B, stride, 0, 1);
  const double excess = excess_trace<Dim>(t.aa, t.bb, t.cc);
  double energy = 0.5 * m.k1 * excess + 0.25 * m.k3 * excess * excess;
  if (m.k2 == 0) return energy;
  double second = minor(t.aa, t.bb, t.ab, t.a, t.b) - 1;
  if (Dim == 3)
    second += (minor(t.aa, t.cc, t.ac, t.a, t.c) - 1) + (minor(t.bb, t.cc, t.bc, t.b, t.c) - 1);
  else
    second += (*t.aa - 1) + (*t.bb - 1);
  return energy + 0.5 * m.k2 * second;
}

/// sigma : grad v, sigma without its pressure; `v` points to the faces of the cell.
template <int Dim>
inline double power_density(const double *const *B, const double *const *v, const std::ptrdiff_t *stride,
                            const double *inverse_spacing, const MooneyRivlin &m) noexcept {
  double power = 0;
  for (int a = 0; a < Dim; ++a)
    power += mooney_rivlin_normal<Dim>(tensor_at<Dim>(B, stride, a, (a + 1) % Dim), 0, m) *
             (inverse_spacing[a] * (v[a][stride[a]] - v[a][0]));
  for (int a = 0; a < Dim; ++a)
    for (int b = a + 1; b < Dim; ++b) {
      const TensorAt t = tensor_at<Dim>(B, stride, a, b);
      double linear = 0, product = 0;
      for (const std::ptrdiff_t edge : {std::ptrdiff_t{0}, t.a, t.b, t.a + t.b}) {
        const double rate =
            inverse_spacing[b] * (v[a][edge] - v[a][edge - t.b]) + inverse_spacing[a] * (v[b][edge] - v[b][edge - t.a]);
        linear += t.ab[edge] * rate;
        if (Dim == 3) product += vertex_product(t.ac + edge, t.bc + edge, t.a, t.b, t.c) * rate;
      }
      power += 0.25 * (shear_factor<Dim>(t.aa, t.bb, t.cc, m) * linear - m.k2 * product);
    }
  return power;
}

}  // namespace eulastic::kernels
