// WENO5 (Jiang & Shu, JCP 126, 1996) in the non-conservative, upwind form v.grad q.
#pragma once

#include "grid/segment.hpp"
#include "kernels/isa.hpp"

namespace eulastic::kernels {

/// Flops of one upwind derivative times its velocity, added to a sum; a fused multiply-add counts two.
inline constexpr double weno5_flops = 77;

/// h dq/dx at q[0], upwind for the sign of `velocity`, from seven points at `stride`. epsilon is 1e-6 (field scale)^2.
///
/// In differences d and second differences e of the upwind stencil, with c = q[0] - q[-1] (upwind from the left):
///   D_0 = c + (5 e1 - 2 e0)/6,  D_1 = c + (e1 + 2 e2)/6,  D_2 = c + (4 e2 - e3)/6
///   IS_0 = 13/12 (e1 - e0)^2 + 1/4 (3 e1 - e0)^2,  IS_1 = 13/12 (e2 - e1)^2 + 1/4 (e1 + e2)^2,
///   IS_2 = 13/12 (e3 - e2)^2 + 1/4 (3 e2 - e3)^2,  weights (.1, .6, .3)/(epsilon + IS)^2.
/// Upwind from the right is the mirror image: e in reverse order and with the opposite sign.
EULASTIC_INLINE double weno5_difference(const double *q, std::ptrdiff_t stride, double velocity,
                                        double epsilon) noexcept {
  const double d0 = q[-2 * stride] - q[-3 * stride], d1 = q[-stride] - q[-2 * stride], d2 = q[0] - q[-stride];
  const double d3 = q[stride] - q[0], d4 = q[2 * stride] - q[stride], d5 = q[3 * stride] - q[2 * stride];
  const bool from_left = velocity > 0;
  const double c = from_left ? d2 : d3;
  const double f1 = d2 - d1, f2 = d3 - d2, f3 = d4 - d3;
  const double e0 = from_left ? d1 - d0 : d5 - d4;
  const double e1 = from_left ? f1 : f3;
  const double e2 = f2;
  const double e3 = from_left ? f3 : f1;
  const double s0 = e1 - e0, s1 = e2 - e1, s2 = e3 - e2;
  const double t0 = fma(3, e1, -e0), t1 = e1 + e2, t2 = fma(3, e2, -e3);
  const double i0 = fma(13. / 3 * s0, s0, fma(t0, t0, 4 * epsilon));
  const double i1 = fma(13. / 3 * s1, s1, fma(t1, t1, 4 * epsilon));
  const double i2 = fma(13. / 3 * s2, s2, fma(t2, t2, 4 * epsilon));
  const double q0 = i1 * i2, q1 = i0 * i2, q2 = i0 * i1;
  const double w0 = q0 * q0, w1 = 6 * (q1 * q1), w2 = 3 * (q2 * q2);
  const double p0 = fma(5, e1, -2 * e0), p1 = fma(2, e2, e1), p2 = fma(4, e2, -e3);
  const double above = fma(w0, p0, fma(w1, p1, w2 * p2));
  const double below = 6 * (w0 + (w1 + w2));
  const double correction = above / below;
  return from_left ? c + correction : c - correction;
}

/// rate[i] -= v . grad q on segment s. `velocity[d]` and `rate` are rows indexed like q's; q needs three ghosts.
template <int Dim>
EULASTIC_INLINE void subtract_advection(const Segment &s, ConstView q, const double *const *velocity,
                                        const double *inverse_spacing, double epsilon, double *rate) noexcept {
  const double *centre = q.row(s.j, s.k);
  const std::ptrdiff_t sy = q.sy, sz = q.sz;
  const double *u = velocity[0], *v = velocity[1], *w = velocity[Dim == 3 ? 2 : 0];
  const double ix = inverse_spacing[0], iy = inverse_spacing[1], iz = inverse_spacing[2];
#pragma omp simd
  for (int i = s.i_begin; i < s.i_end; ++i) {
    double sum = u[i] * ix * weno5_difference(centre + i, 1, u[i], epsilon);
    sum = fma(v[i] * iy, weno5_difference(centre + i, sy, v[i], epsilon), sum);
    if constexpr (Dim == 3) sum = fma(w[i] * iz, weno5_difference(centre + i, sz, w[i], epsilon), sum);
    rate[i] -= sum;
  }
}

}  // namespace eulastic::kernels
