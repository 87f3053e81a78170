// The Mooney-Rivlin law: sigma = phi dev(2 c1 B + 2 c2 (tr(B) B - B.B) + 4 c3 (tr B - 3) B). With tr(B) B - B.B = II I
// - cof B and the minors M_ab = B_aa B_bb - B_ab^2, its diagonal is M_ab + M_ac and its off-diagonal component B_cc
// B_ab - B_ac B_bc (Sugiyama et al., J. Comput. Phys. 230, 2011; docs/method.md, section 13).
#pragma once

#include "kernels/tensor.hpp"

namespace eulastic::kernels {

/// Returns M_ab at a centre; the squares are formed on the edges and then averaged.
EULASTIC_INLINE double minor(const double *aa, const double *bb, const double *ab, std::ptrdiff_t a,
                             std::ptrdiff_t b) noexcept {
  const double squares = (ab[0] * ab[0] + ab[a] * ab[a]) + (ab[b] * ab[b] + ab[a + b] * ab[a + b]);
  return fma(*aa, *bb, -0.25 * squares);
}

/// Returns B_ac B_bc on the edge ab; the products are formed at the two vertices and then averaged along c.
EULASTIC_INLINE double vertex_product(const TensorAt<3> &t, std::ptrdiff_t i) noexcept {
  const double *ac = t.ac + i, *bc = t.bc + i;
  return 0.125 * ((bc[0] + bc[-t.a]) * (ac[0] + ac[-t.b]) + (bc[t.c] + bc[t.c - t.a]) * (ac[t.c] + ac[t.c - t.b]));
}

/// The members are documented in NeoHookean.
struct MooneyRivlin {
  static constexpr bool couples_edges = true;
  double k1, k2, k3;  ///< 2 c1, 2 c2, 4 c3

  MooneyRivlin scaled(double factor) const noexcept { return {factor * k1, factor * k2, factor * k3}; }
  double shear_modulus() const noexcept { return k1 + k2; }
  double stiffening() const noexcept { return k3; }  ///< exact in plane strain; in 3-D c2 counts as at rest
  static constexpr double flops(int dimension) noexcept { return dimension == 2 ? 124 : 310; }
  double stiffness(const StretchBounds &b) const noexcept {
    const double spread = b.stretch - 1 / b.inverse;
    return (k1 + k3 * b.excess) * b.stretch + k2 * b.inverse + 0.5 * k3 * spread * spread;
  }

  template <int Dim>
  EULASTIC_INLINE double normal_stress(double phi, const TensorAt<Dim> &t, std::ptrdiff_t i) const noexcept {
    const double *aa = t.aa + i, *bb = t.bb + i, *cc = t.cc + i;
    const double zz = Dim == 3 ? *cc : 1.0;
    const double ab = minor(aa, bb, t.ab + i, t.a, t.b);
    const double ac = Dim == 3 ? minor(aa, cc, t.ac + i, t.a, t.c) : *aa;
    const double bc = Dim == 3 ? minor(bb, cc, t.bc + i, t.b, t.c) : *bb;
    const double first = fma(k3, excess_trace(t, i), k1) * ((*aa - *bb) + (*aa - zz));
    return phi * ((1. / 3) * fma(k2, (ac - bc) + (ab - bc), first));
  }
  template <int Dim>
  EULASTIC_INLINE double shear_stress(const double *phi, const TensorAt<Dim> &t, std::ptrdiff_t i) const noexcept {
    const auto weight = [&](std::ptrdiff_t o) EULASTIC_BODY { return phi[o] * shear_factor(t, o); };
    const double sum = (weight(i) + weight(i - t.a)) + (weight(i - t.b) + weight(i - t.a - t.b));
    const double stress = 0.25 * sum * t.ab[i];
    if constexpr (Dim == 3)
      return fma(-k2 * average4(phi + i, -t.a, -t.b), vertex_product(t, i), stress);
    else
      return stress;
  }
  /// Returns 2 c1 + 2 c2 B_cc + 4 c3 (tr B - 3).
  template <int Dim>
  EULASTIC_INLINE double shear_factor(const TensorAt<Dim> &t, std::ptrdiff_t i) const noexcept {
    return fma(k3, excess_trace(t, i), fma(k2, Dim == 3 ? t.cc[i] : 1.0, k1));
  }
  /// Returns c1 (I - 3) + c2 (II - 3) + c3 (I - 3)^2.
  template <int Dim>
  EULASTIC_INLINE double energy(const TensorAt<Dim> &t, std::ptrdiff_t i) const noexcept {
    const double *aa = t.aa + i, *bb = t.bb + i, *cc = t.cc + i;
    const double excess = excess_trace(t, i);
    double second = minor(aa, bb, t.ab + i, t.a, t.b) - 1;
    if (Dim == 3)
      second += (minor(aa, cc, t.ac + i, t.a, t.c) - 1) + (minor(bb, cc, t.bc + i, t.b, t.c) - 1);
    else
      second += (*aa - 1) + (*bb - 1);
    return 0.5 * k1 * excess + 0.25 * k3 * excess * excess + 0.5 * k2 * second;
  }
};

}  // namespace eulastic::kernels
