// The stretching terms L.B + B.L^T of (5), at centres for the diagonal and on edges for the other components.
#pragma once

#include "kernels/solid_shear.hpp"

namespace eulastic::kernels {

inline constexpr double stretch_diagonal_flops_2d = 20, stretch_diagonal_flops_3d = 37;
inline constexpr double stretch_shear_flops_2d = 27, stretch_shear_flops_3d = 58;

/// Returns the mean over the four edges around a centre of B_ab times `slope` (a derivative times h) of the edges at
/// offsets from it. The product is formed first, so that the elastic energy gains the power that is taken from the
/// flow.
template <class Slope>
EULASTIC_INLINE double edge_power(const double *ab, std::ptrdiff_t a, std::ptrdiff_t b, Slope slope) noexcept {
  return 0.25 * ((ab[0] * slope(0) + ab[a] * slope(a)) + (ab[b] * slope(b) + ab[a + b] * slope(a + b)));
}

/// Returns B_aa dv_a/dx_a + avg4(B_ab dv_a/dx_b) + avg4(B_ac dv_a/dx_c), half the rate of B_aa; 2-D does not use ac.
/// `shear`: MixtureShear or SolidShear at this point.
template <int Dim, class Shear>
EULASTIC_INLINE double half_diagonal_stretch(const double *aa, const double *ab, const double *ac, const Shear &shear,
                                             const Directions &d) noexcept {
  const auto b = [&](std::ptrdiff_t o) EULASTIC_BODY { return shear.template slope<0, 1>(d, o); };
  const auto c = [&](std::ptrdiff_t o) EULASTIC_BODY { return shear.template slope<0, 2>(d, o); };
  double sum = aa[0] * (d.ia * (shear.v[0][d.a] - shear.v[0][0]));
  sum = fma(d.ib, edge_power(ab, d.a, d.b, b), sum);
  if constexpr (Dim == 3) sum = fma(d.ic, edge_power(ac, d.a, d.c, c), sum);
  return sum;
}

/// Returns 4 h dv_a/dx_a averaged to the edge ab.
EULASTIC_INLINE double normal_rate4(const double *va, std::ptrdiff_t a, std::ptrdiff_t b) noexcept {
  return (va[a] - va[-a]) + (va[a - b] - va[-a - b]);
}

/// Returns the rate of B_ab, B_aa dv_b/dx_a + B_bb dv_a/dx_b + B_ab (dv_a/dx_a + dv_b/dx_b) + B_bc dv_a/dx_c + B_ac
/// dv_b/dx_c. The last two terms are formed at the vertices below and above the edge; 2-D does not use bc and ac.
template <int Dim, class Shear>
EULASTIC_INLINE double shear_stretch(const double *aa, const double *bb, const double *ab, const double *bc,
                                     const double *ac, const Shear &shear, const Directions &d) noexcept {
  double sum = average4(aa, -d.a, -d.b) * (d.ia * shear.template slope<1, 0>(d, 0));
  sum = fma(average4(bb, -d.a, -d.b), d.ib * shear.template slope<0, 1>(d, 0), sum);
  const double rates =
      fma(0.25 * d.ia, normal_rate4(shear.v[0], d.a, d.b), 0.25 * d.ib * normal_rate4(shear.v[1], d.b, d.a));
  sum = fma(ab[0], rates, sum);
  if constexpr (Dim == 3) {
    // The last two terms times 4 h_c at the vertex at offset o below the edge: B_bc averaged along a, the shear along
    // b.
    const auto vertex = [&](std::ptrdiff_t o) EULASTIC_BODY {
      const double first =
          (bc[o] + bc[o - d.a]) * (shear.template slope<0, 2>(d, o) + shear.template slope<0, 2>(d, o - d.b));
      return first +
             (ac[o] + ac[o - d.b]) * (shear.template slope<1, 2>(d, o) + shear.template slope<1, 2>(d, o - d.a));
    };
    sum = fma(0.125 * d.ic, vertex(0) + vertex(d.c), sum);
  }
  return sum;
}

}  // namespace eulastic::kernels
