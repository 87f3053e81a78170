// The Mooney-Rivlin stress phi dev(2 c1 B + 2 c2 (tr(B) B - B.B) + 4 c3 (tr B - 3) B) and its divergence at the faces
// of one velocity component. tr(B) B - B.B = II I - cof B: with the minors M_ab = B_aa B_bb - B_ab^2 its diagonal is
// M_ab + M_ac, and B_cc B_ab - B_ac B_bc stands off it (Sugiyama et al., J. Comput. Phys. 230, 2011; docs/method.md).
#pragma once

#include "kernels/elastic.hpp"

namespace eulastic::kernels {

inline constexpr double mooney_rivlin_flops_2d = 124, mooney_rivlin_flops_3d = 310;  ///< per face

/// 2 c1, 2 c2, 4 c3; neo-Hookean: G, 0, 0.
struct MooneyRivlin {
  double k1, k2, k3;
};

/// B around one centre: pointers to its components and the strides of the directions a, b, c. In 2-D c is unused.
struct TensorAt {
  const double *aa, *bb, *cc, *ab, *ac, *bc;
  std::ptrdiff_t a, b, c;
};

/// tr B - 3; 2-D: B_zz = 1.
template <int Dim>
EULASTIC_INLINE double excess_trace(const double *aa, const double *bb, const double *cc) noexcept {
  const double sum = (*aa - 1) + (*bb - 1);
  return Dim == 3 ? sum + (*cc - 1) : sum;
}

/// M_ab at a centre: the square on the edges, then the average.
EULASTIC_INLINE double minor(const double *aa, const double *bb, const double *ab, std::ptrdiff_t a,
                             std::ptrdiff_t b) noexcept {
  const double squares = (ab[0] * ab[0] + ab[a] * ab[a]) + (ab[b] * ab[b] + ab[a + b] * ab[a + b]);
  return fma(*aa, *bb, -0.25 * squares);
}

/// (sigma_aa - tr sigma / 3)/phi at the centre at offset i.
template <int Dim>
EULASTIC_INLINE double mooney_rivlin_normal(const TensorAt &t, std::ptrdiff_t i, const MooneyRivlin &m) noexcept {
  const double *aa = t.aa + i, *bb = t.bb + i, *cc = t.cc + i;
  const double zz = Dim == 3 ? *cc : 1.0;
  const double ab = minor(aa, bb, t.ab + i, t.a, t.b);
  const double ac = Dim == 3 ? minor(aa, cc, t.ac + i, t.a, t.c) : *aa;
  const double bc = Dim == 3 ? minor(bb, cc, t.bc + i, t.b, t.c) : *bb;
  const double first = fma(m.k3, excess_trace<Dim>(aa, bb, cc), m.k1) * ((*aa - *bb) + (*aa - zz));
  return (1. / 3) * fma(m.k2, (ac - bc) + (ab - bc), first);
}

/// 2 c1 + 2 c2 B_cc + 4 c3 (tr B - 3) at a centre: what multiplies B_ab.
template <int Dim>
EULASTIC_INLINE double shear_factor(const double *aa, const double *bb, const double *cc,
                                    const MooneyRivlin &m) noexcept {
  return fma(m.k3, excess_trace<Dim>(aa, bb, cc), fma(m.k2, Dim == 3 ? *cc : 1.0, m.k1));
}

/// B_ac B_bc on the edge ab: formed at the two vertices, then averaged along c.
EULASTIC_INLINE double vertex_product(const double *ac, const double *bc, std::ptrdiff_t a, std::ptrdiff_t b,
                                      std::ptrdiff_t c) noexcept {
  return 0.125 * ((bc[0] + bc[-a]) * (ac[0] + ac[-b]) + (bc[c] + bc[c - a]) * (ac[c] + ac[c - b]));
}

/// sigma_ab on the edge at offset i.
template <int Dim>
EULASTIC_INLINE double mooney_rivlin_shear(const double *phi, const TensorAt &t, std::ptrdiff_t i,
                                           const MooneyRivlin &m) noexcept {
  const auto weight = [&](std::ptrdiff_t o) { return phi[o] * shear_factor<Dim>(t.aa + o, t.bb + o, t.cc + o, m); };
  const double sum = (weight(i) + weight(i - t.a)) + (weight(i - t.b) + weight(i - t.a - t.b));
  double stress = 0.25 * sum * t.ab[i];
  if constexpr (Dim == 3)
    stress = fma(-m.k2 * average4(phi + i, -t.a, -t.b), vertex_product(t.ac + i, t.bc + i, t.a, t.b, t.c), stress);
  return stress;
}

/// add(offset, div(sigma)_a) for all points. Strides and 1/h of the directions a, b, c; in 2-D c is unused.
template <int Dim, class Points, class Add>
EULASTIC_INLINE void mooney_rivlin_force(const Points &points, ConstView phi, const TensorViews &tensor, ConstView bc,
                                         const std::ptrdiff_t *stride, const double *inverse_spacing,
                                         const MooneyRivlin &m, Add add) noexcept {
  const std::ptrdiff_t da = stride[0], db = stride[1], dc = stride[2];
  const double ia = inverse_spacing[0], ib = inverse_spacing[1], ic = inverse_spacing[2];
  const double *f = phi.origin, *aa = tensor.aa.origin, *bb = tensor.bb.origin, *ab = tensor.ab.origin;
  const double *cc = Dim == 3 ? tensor.cc.origin : aa, *ac = Dim == 3 ? tensor.ac.origin : ab;
  const double *b_c = Dim == 3 ? bc.origin : ab;
  const TensorAt t{aa, bb, cc, ab, ac, b_c, da, db, dc}, swapped{aa, cc, bb, ac, ab, b_c, da, dc, db};
  for_points(points, phi, [=](std::ptrdiff_t i, int) EULASTIC_BODY {
    double sum = ia * (f[i] * mooney_rivlin_normal<Dim>(t, i, m) - f[i - da] * mooney_rivlin_normal<Dim>(t, i - da, m));
    sum = fma(ib, mooney_rivlin_shear<Dim>(f, t, i + db, m) - mooney_rivlin_shear<Dim>(f, t, i, m), sum);
    if constexpr (Dim == 3)
      sum = fma(ic, mooney_rivlin_shear<Dim>(f, swapped, i + dc, m) - mooney_rivlin_shear<Dim>(f, swapped, i, m), sum);
    add(i, sum);
  });
}

}  // namespace eulastic::kernels
