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

/// rate += 2 (B_aa dv_a/dx_a + avg4(B_ab dv_a/dx_b) + avg4(B_ac dv_a/dx_c)).
template <int Dim>
EULASTIC_INLINE void add_diagonal_stretch(const Segment &s, ConstView aa, ConstView ab, ConstView ac, ConstView va,
                                          const Directions &d, double *rate) noexcept {
  const double *baa = aa.row(s.j, s.k), *bab = ab.row(s.j, s.k), *v = va.row(s.j, s.k);
  const double *bac = Dim == 3 ? ac.row(s.j, s.k) : bab;
#pragma omp simd
  for (int i = s.i_begin; i < s.i_end; ++i) {
    double sum = baa[i] * (d.ia * (v[i + d.a] - v[i]));
    sum = fma(d.ib, edge_power(bab + i, v + i, d.a, d.b), sum);
    if constexpr (Dim == 3) sum = fma(d.ic, edge_power(bac + i, v + i, d.a, d.c), sum);
    rate[i] = fma(2, sum, rate[i]);
  }
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

/// rate += B_aa dv_b/dx_a + B_bb dv_a/dx_b + B_ab (dv_a/dx_a + dv_b/dx_b) + B_bc dv_a/dx_c + B_ac dv_b/dx_c.
template <int Dim>
EULASTIC_INLINE void add_shear_stretch(const Segment &s, ConstView aa, ConstView bb, ConstView ab, ConstView bc,
                                       ConstView ac, ConstView va, ConstView vb, const Directions &d,
                                       double *rate) noexcept {
  const double *baa = aa.row(s.j, s.k), *bbb = bb.row(s.j, s.k), *bab = ab.row(s.j, s.k);
  const double *bbc = Dim == 3 ? bc.row(s.j, s.k) : baa, *bac = Dim == 3 ? ac.row(s.j, s.k) : baa;
  const double *u = va.row(s.j, s.k), *v = vb.row(s.j, s.k);
#pragma omp simd
  for (int i = s.i_begin; i < s.i_end; ++i) {
    double sum = average4(baa + i, -d.a, -d.b) * (d.ia * (v[i] - v[i - d.a]));
    sum = fma(average4(bbb + i, -d.a, -d.b), d.ib * (u[i] - u[i - d.b]), sum);
    const double rates = fma(0.25 * d.ia, normal_rate4(u + i, d.a, d.b), 0.25 * d.ib * normal_rate4(v + i, d.b, d.a));
    sum = fma(bab[i], rates, sum);
    if constexpr (Dim == 3) {
      const double low = vertex_power4(bbc + i, u + i, d.a, d.b, d.c) + vertex_power4(bac + i, v + i, d.b, d.a, d.c);
      const double high = vertex_power4(bbc + i + d.c, u + i + d.c, d.a, d.b, d.c) +
                          vertex_power4(bac + i + d.c, v + i + d.c, d.b, d.a, d.c);
      sum = fma(0.125 * d.ic, low + high, sum);
    }
    rate[i] += sum;
  }
}

}  // namespace eulastic::kernels
