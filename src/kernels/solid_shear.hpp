// Shear of the solid on edges that solid and fluid share; docs/method.md, section 16, (29b) and (29c).
#pragma once

#include "kernels/stencils.hpp"

namespace eulastic::kernels {

/// Strides and 1/h of the directions a, b, c in that order. In 2-D c is unused.
struct Directions {
  std::ptrdiff_t a, b, c;
  double ia, ib, ic;

  template <int X>
  EULASTIC_INLINE std::ptrdiff_t stride() const noexcept {
    return X == 0 ? a : X == 1 ? b : c;
  }
  template <int X>
  EULASTIC_INLINE double inverse() const noexcept {
    return X == 0 ? ia : X == 1 ? ib : ic;
  }
  /// Returns the directions with X and Y first.
  template <int X, int Y>
  EULASTIC_INLINE Directions reordered() const noexcept {
    constexpr int Z = 3 - X - Y;
    return {stride<X>(), stride<Y>(), stride<Z>(), inverse<X>(), inverse<Y>(), inverse<Z>()};
  }
};

/// Velocity differences of the mixture. `v` points to the velocities along a, b, c at a point.
struct MixtureShear {
  const double *v[3];

  /// Returns h_y dv_x/dx_y on the edge xy at offset o from the point.
  template <int X, int Y>
  EULASTIC_INLINE double slope(const Directions &d, std::ptrdiff_t o) const noexcept {
    return v[X][o] - v[X][o - d.stride<Y>()];
  }
};

/// The solid has the factor `part` of the rate of shear of an edge, 1 + (r - 1) q in (29c). The rest is a kink of the
/// velocity, of which derivatives along b have the share `along`.
struct EdgeKink {
  double part, along;
};

/// Returns the kink on the edge ab at `phi`; `excess` = mu_s/mu_f - 1.
template <int Dim>
EULASTIC_INLINE EdgeKink edge_kink(const double *phi, const Directions &d, double excess) noexcept {
  const double *f = phi, low = f[-d.a] + f[-d.a - d.b], high = f[0] + f[-d.b];
  const double nx = d.ia * (high - low), ny = d.ib * ((f[0] + f[-d.a]) - (f[-d.b] + f[-d.a - d.b]));
  const double nz = Dim == 3 ? 0.25 * d.ic * (sum4(f + d.c, -d.a, -d.b) - sum4(f - d.c, -d.a, -d.b)) : 0;
  const double xx = nx * nx, yy = ny * ny, plane = xx + yy, sum = plane + nz * nz, divisor = sum > 0 ? sum : 1;
  // share of shear between n and tangents in the tensor ab
  const double normal = (plane - 4 * (xx * (yy / divisor))) / divisor;
  const double rest = 1 - average4(f, -d.a, -d.b), below = rest < 1 ? rest : 1, fluid = below > 0 ? below : 0;
  return {fma(1 / fma(excess, fluid, 1) - 1, normal, 1), plane > 0 ? yy / plane : 0.5};
}

/// Velocity differences of the solid by (29c). `phi` is at the point, too.
template <int Dim>
struct SolidShear {
  const double *v[3], *phi;
  double excess;

  template <int X, int Y>
  EULASTIC_INLINE double slope(const Directions &d, std::ptrdiff_t o) const noexcept {
    const Directions seen = d.reordered<X, Y>();
    const EdgeKink kink = edge_kink<Dim>(phi + o, seen, excess);
    const double own = v[X][o] - v[X][o - seen.b], other = v[Y][o] - v[Y][o - seen.a];
    return fma((kink.part - 1) * kink.along, own + seen.ia / seen.ib * other, own);
  }
};

/// The solid has the viscosity of the fluid.
struct SameViscosity {
  /// Returns the factor of the elastic stress on the edge ab at `phi`.
  template <int Dim>
  EULASTIC_INLINE double part(const double *, const Directions &) const noexcept {
    return 1;
  }
  /// Returns the velocity differences that stretch B, from the velocities along the directions and phi.
  template <int Dim>
  EULASTIC_INLINE MixtureShear shear(const double *va, const double *vb, const double *vc,
                                     const double *) const noexcept {
    return {{va, vb, vc}};
  }
};

/// The solid has a viscosity of its own; `excess` = mu_s/mu_f - 1.
struct SolidViscosity {
  double excess;

  template <int Dim>
  EULASTIC_INLINE double part(const double *phi, const Directions &d) const noexcept {
    return edge_kink<Dim>(phi, d, excess).part;
  }
  template <int Dim>
  EULASTIC_INLINE SolidShear<Dim> shear(const double *va, const double *vb, const double *vc,
                                        const double *phi) const noexcept {
    return {{va, vb, vc}, phi, excess};
  }
};

}  // namespace eulastic::kernels
