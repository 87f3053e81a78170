// B at a point of a surface: the normal, what the continuity of traction says of the kink of the velocity there, and
// the fading memory of what lies there. docs/method.md, section 7. Without branches: many points go through one loop.
//
// K: B <- S B S^T, S = 1 - s t n^T, t = Bn - (n.Bn) n, s = (1 - e^(-(1 - phi) k n.Bn dt))/(n.Bn).
#pragma once

#include "kernels/exp.hpp"
#include "kernels/stencils.hpp"

namespace eulastic::kernels {

struct Direction {
  double x, y, z;
};
/// Symmetric, all components at one point; in 2-D xz = yz = 0.
struct SymmetricTensor {
  double xx, yy, zz, yz, xz, xy;
};

/// Multiply-adds and the like: of the gradient and the strain rate at a centre, and of K and F at a point.
inline constexpr double gradient_flops_2d = 35, gradient_flops_3d = 115, surface_flops_2d = 165, surface_flops_3d = 225;

EULASTIC_INLINE double determinant(const SymmetricTensor &t) noexcept {
  return t.xx * (t.yy * t.zz - t.yz * t.yz) - t.xy * (t.xy * t.zz - t.yz * t.xz) + t.xz * (t.xy * t.yz - t.yy * t.xz);
}

/// Component d of the gradient of phi at a centre, up to a factor that is the same for all: 1-2-1 across.
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

/// sqrt(2 D:D) at a centre, D the symmetric gradient of the velocity (pointers to its components).
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

/// Of unit length; 0 where the gradient is.
EULASTIC_INLINE Direction unit(const Direction &g) noexcept {
  const double square = fma(g.x, g.x, fma(g.y, g.y, g.z * g.z));
  const double scale = square > 0 ? 1 / __builtin_sqrt(square) : 0;
  return {scale * g.x, scale * g.y, scale * g.z};
}

/// e^-x, x >= 0; beyond 700 as there.
EULASTIC_INLINE double decay(double x) noexcept { return exp(x < 700 ? -x : -700.0); }

/// K at a point: S B S^T, whose determinant is that of B. `strength` = (1 - phi) k dt.
EULASTIC_INLINE SymmetricTensor relax_traction(const SymmetricTensor &B, const Direction &n, double strength) noexcept {
  const double x = fma(B.xx, n.x, fma(B.xy, n.y, B.xz * n.z)), y = fma(B.xy, n.x, fma(B.yy, n.y, B.yz * n.z)),
               z = fma(B.xz, n.x, fma(B.yz, n.y, B.zz * n.z));  // Bn
  const double across = fma(n.x, x, fma(n.y, y, n.z * z));
  const double decayed = decay(strength * across);
  const double s = across > 0 ? (1 - decayed) / across : 0;  // means need not be positive definite: then there is no K
  const double u = fma(-across, n.x, x), v = fma(-across, n.y, y), w = fma(-across, n.z, z), r = s * s * across;  // t
  return {fma(r * u, u, fma(-2 * s * u, x, B.xx)),   fma(r * v, v, fma(-2 * s * v, y, B.yy)),
          fma(r * w, w, fma(-2 * s * w, z, B.zz)),   fma(r * v, w, B.yz - s * (v * z + y * w)),
          fma(r * u, w, B.xz - s * (u * z + x * w)), fma(r * u, v, B.xy - s * (u * y + x * v))};
}

}  // namespace eulastic::kernels
