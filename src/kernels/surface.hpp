// B at a point of a surface: the normal, the correction for the kink of the velocity that continuity of traction
// implies, (22), and the decay of the relaxation (23). docs/method.md, section 7. Free of branches, so that loops over
// many points vectorise.
//
// (22): B <- S B S^T, S = 1 - s t n^T, t = Bn - (n.Bn) n, s = (1 - e^(-(1 - phi) k n.Bn dt))/(n.Bn).
#pragma once

#include "kernels/exp.hpp"
#include "kernels/stencils.hpp"

namespace eulastic::kernels {

/// A vector at one point.
struct Direction {
  double x, y, z;
};
/// All components of a symmetric tensor at one point; in 2-D xz = yz = 0.
struct SymmetricTensor {
  double xx, yy, zz, yz, xz, xy;
};

/// Flops of the gradient and the strain rate at a centre, and of (22) and (23) at a point.
inline constexpr double gradient_flops_2d = 35, gradient_flops_3d = 115, surface_flops_2d = 165, surface_flops_3d = 225;

EULASTIC_INLINE double determinant(const SymmetricTensor &t) noexcept {
  return t.xx * (t.yy * t.zz - t.yz * t.yz) - t.xy * (t.xy * t.zz - t.yz * t.xz) + t.xz * (t.xy * t.yz - t.yy * t.xz);
}

/// Returns component d of the gradient of phi at a centre, averaged 1-2-1 across, up to a factor that is the same for
/// all components.
template <int Dim>
EULASTIC_INLINE double fraction_slope(const double *phi, int d, const std::ptrdiff_t *stride,
                                      const double *inverse_spacing) noexcept {
  const auto along = [=](std::ptrdiff_t o) EULASTIC_BODY { return phi[o + stride[d]] - phi[o - stride[d]]; };
  const auto across = [](const auto &value, std::ptrdiff_t s, std::ptrdiff_t o)
                          EULASTIC_BODY { return fma(2, value(o), value(o - s) + value(o + s)); };
  const std::ptrdiff_t e = stride[(d + 1) % Dim];
  if constexpr (Dim == 2) return inverse_spacing[d] * across(along, e, 0);
  const std::ptrdiff_t f = stride[(d + 2) % 3];
  return inverse_spacing[d] *
         across([=](std::ptrdiff_t o) EULASTIC_BODY { return across(along, e < f ? e : f, o); }, e < f ? f : e, 0);
}

/// Returns sqrt(2 D:D) at a centre, where D is the symmetric velocity gradient; `v` points to the velocity components.
template <int Dim>
EULASTIC_INLINE double strain_rate(const double *const *v, std::ptrdiff_t o, const std::ptrdiff_t *stride,
                                   const double *inverse_spacing) noexcept {
  double sum = 0;
#pragma GCC unroll 3
  for (int a = 0; a < Dim; ++a) {
    const double *u = v[a] + o;
    const std::ptrdiff_t s = stride[a];
    const double stretch = inverse_spacing[a] * (u[s] - u[0]);
    sum = fma(2 * stretch, stretch, sum);
#pragma GCC unroll 3
    for (int b = a + 1; b < Dim; ++b) {
      const double *w = v[b] + o;
      const std::ptrdiff_t t = stride[b];
      const double shear = fma(0.25 * inverse_spacing[b], (u[t] - u[-t]) + (u[s + t] - u[s - t]),
                               0.25 * inverse_spacing[a] * ((w[s] - w[-s]) + (w[s + t] - w[t - s])));  // twice D_ab
      sum = fma(shear, shear, sum);
    }
  }
  return __builtin_sqrt(sum);
}

/// Returns the unit vector along g, or 0 if g is 0.
EULASTIC_INLINE Direction unit(const Direction &g) noexcept {
  const double square = fma(g.x, g.x, fma(g.y, g.y, g.z * g.z));
  const double scale = square > 0 ? 1 / __builtin_sqrt(square) : 0;
  return {scale * g.x, scale * g.y, scale * g.z};
}

/// Returns e^-x for x >= 0, and e^-700 for x > 700.
EULASTIC_INLINE double decay(double x) noexcept { return exp(x < 700 ? -x : -700.0); }

/// Returns S B S^T of (22), whose determinant is that of B. `strength` = (1 - phi) k dt.
EULASTIC_INLINE SymmetricTensor relax_traction(const SymmetricTensor &B, const Direction &n, double strength) noexcept {
  const double x = fma(B.xx, n.x, fma(B.xy, n.y, B.xz * n.z)), y = fma(B.xy, n.x, fma(B.yy, n.y, B.yz * n.z)),
               z = fma(B.xz, n.x, fma(B.yz, n.y, B.zz * n.z));  // Bn
  const double across = fma(n.x, x, fma(n.y, y, n.z * z));
  const double decayed = decay(strength * across);
  const double s = across > 0 ? (1 - decayed) / across : 0;  // 0 for a mean that is not positive definite
  const double u = fma(-across, n.x, x), v = fma(-across, n.y, y), w = fma(-across, n.z, z), r = s * s * across;  // t
  return {fma(r * u, u, fma(-2 * s * u, x, B.xx)),   fma(r * v, v, fma(-2 * s * v, y, B.yy)),
          fma(r * w, w, fma(-2 * s * w, z, B.zz)),   fma(r * v, w, B.yz - s * (v * z + y * w)),
          fma(r * u, w, B.xz - s * (u * z + x * w)), fma(r * u, v, B.xy - s * (u * y + x * v))};
}

}  // namespace eulastic::kernels
