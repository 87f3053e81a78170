// The stretching terms L.B + B.L^T of (5), on centres for the diagonal and on edges for the off-diagonal components.
#pragma once

#include "kernels/stencils.hpp"

namespace eulastic::kernels {

inline constexpr double stretch_diagonal_flops_2d = 20, stretch_diagonal_flops_3d = 37;
inline constexpr double stretch_shear_flops_2d = 27, stretch_shear_flops_3d = 58;

/// Strides and 1/h of the directions a, b, c in that order.
struct Directions {
  std::ptrdiff_t a, b, c;
  double ia, ib, ic;
};

/// Mean over the four edges around a centre of B_ab dv_a/dx_b: the product first, then the average, so that the
/// power taken from the momentum equation is the power the elastic energy gains.
EULASTIC_INLINE double edge_power(const double *ab, const double *va, std::ptrdiff_t a, std::ptrdiff_t b) noexcept {
  return 0.25 * ((ab[0] * (va[0] - va[-b]) + ab[a] * (va[a] - va[a - b])) +
                 (ab[b] * (va[b] - va[0]) + ab[a + b] * (va[a + b] - va[a])));
}

/// B_aa dv_a/dx_a + avg4(B_ab dv_a/dx_b) + avg4(B_ac dv_a/dx_c), half the rate of B_aa; in 2-D ac is unused.
template <int Dim>
EULASTIC_INLINE double half_diagonal_stretch(const double *aa, const double *ab, const double *ac, const double *va,
                                             const Directions &d) noexcept {
  double sum = aa[0] * (d.ia * (va[d.a] - va[0]));
  sum = fma(d.ib, edge_power(ab, va, d.a, d.b), sum);
  if constexpr (Dim == 3) sum = fma(d.ic, edge_power(ac, va, d.a, d.c), sum);
  return sum;
}

/// 4 h dv_a/dx_a averaged to the edge ab.
EULASTIC_INLINE double normal_rate4(const double *va, std::ptrdiff_t a, std::ptrdiff_t b) noexcept {
  return (va[a] - va[-a]) + (va[a - b] - va[-a - b]);
}

/// B_bc dv_a/dx_c at the vertex below the edge ab (times 4 h_c): B_bc averaged along a, the shear along b.
EULASTIC_INLINE double vertex_power4(const double *bc, const double *va, std::ptrdiff_t a, std::ptrdiff_t b,
                                     std::ptrdiff_t c) noexcept {
  return (bc[0] + bc[-a]) * ((va[0] - va[-c]) + (va[-b] - va[-b - c]));
}

/// B_aa dv_b/dx_a + B_bb dv_a/dx_b + B_ab (dv_a/dx_a + dv_b/dx_b) + B_bc dv_a/dx_c + B_ac dv_b/dx_c, the rate of B_ab;
/// in 2-D bc and ac are unused.
template <int Dim>
EULASTIC_INLINE double shear_stretch(const double *aa, const double *bb, const double *ab, const double *bc,
                                     const double *ac, const double *va, const double *vb,
                                     const Directions &d) noexcept {
  double sum = average4(aa, -d.a, -d.b) * (d.ia * (vb[0] - vb[-d.a]));
  sum = fma(average4(bb, -d.a, -d.b), d.ib * (va[0] - va[-d.b]), sum);
  const double rates = fma(0.25 * d.ia, normal_rate4(va, d.a, d.b), 0.25 * d.ib * normal_rate4(vb, d.b, d.a));
  sum = fma(ab[0], rates, sum);
  if constexpr (Dim == 3) {
    const double low = vertex_power4(bc, va, d.a, d.b, d.c) + vertex_power4(ac, vb, d.b, d.a, d.c);
    const double high =
        vertex_power4(bc + d.c, va + d.c, d.a, d.b, d.c) + vertex_power4(ac + d.c, vb + d.c, d.b, d.a, d.c);
    sum = fma(0.125 * d.ic, low + high, sum);
  }
  return sum;
}

}  // namespace eulastic::kernels
