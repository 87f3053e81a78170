// WENO5 (Jiang & Shu, J. Comput. Phys. 126, 1996) in the non-conservative, upwind form v.grad q.
#pragma once

#include "kernels/stencils.hpp"

namespace eulastic::kernels {

/// Flops of one upwind derivative times its velocity, added to a sum; a fused multiply-add counts two.
inline constexpr double weno5_flops = 56;

/// Returns h dq/dx at q[0], upwind for the sign of `velocity`, from seven points at `stride`. epsilon is 1e-6 (field
/// scale)^2.
///
/// With differences d and second differences e of the upwind stencil, and c = q[0] - q[-1] (upwind from the left):
///   D_0 = c + (5 e1 - 2 e0)/6,  D_1 = c + (e1 + 2 e2)/6,  D_2 = c + (4 e2 - e3)/6
///   IS_0 = 13/12 (e1 - e0)^2 + 1/4 (3 e1 - e0)^2 = 4/3 [(e0 - 11/8 e1)^2 + 39/64 e1^2],
///   IS_1 = 13/12 (e2 - e1)^2 + 1/4 (e1 + e2)^2   = 4/3 [(e2 -  5/8 e1)^2 + 39/64 e1^2],
///   IS_2 = 13/12 (e3 - e2)^2 + 1/4 (3 e2 - e3)^2 = 4/3 [(e3 - 11/8 e2)^2 + 39/64 e2^2],
///   weights (1/6, 1, 1/2)/(epsilon + IS)^2, all three multiplied by 2 (epsilon + IS)^2 of all three stencils.
/// The second form of IS shares two of its squares and has no cancellation. Upwind from the right is the mirror image,
/// with e in reverse order and with the opposite sign. The speed is limited by the number of multiplications and their
/// latency, since a processor overlaps only about five vectors.
EULASTIC_INLINE double weno5_difference(const double *q, std::ptrdiff_t stride, double velocity,
                                        double epsilon) noexcept {
  const double d0 = q[-2 * stride] - q[-3 * stride], d1 = q[-stride] - q[-2 * stride], d2 = q[0] - q[-stride];
  const double d3 = q[stride] - q[0], d4 = q[2 * stride] - q[stride], d5 = q[3 * stride] - q[2 * stride];
  const bool from_left = velocity > 0;
  const double f1 = d2 - d1, f2 = d3 - d2, f3 = d4 - d3;
  const double e0 = from_left ? d1 - d0 : d5 - d4;
  const double e1 = from_left ? f1 : f3;
  const double e2 = f2;
  const double e3 = from_left ? f3 : f1;
  const double h1 = fma(39. / 64 * e1, e1, 0.75 * epsilon), h2 = fma(39. / 64 * e2, e2, 0.75 * epsilon);
  const double a0 = fma(-11. / 8, e1, e0), a1 = fma(-5. / 8, e1, e2), a2 = fma(-11. / 8, e2, e3);
  const double i0 = fma(a0, a0, h1), i1 = fma(a1, a1, h1), i2 = fma(a2, a2, h2);
  const double j0 = i0 * i0, j1 = i1 * i1, j2 = i2 * i2, twice_j2 = j2 + j2, both = j0 * j1;
  const double p0 = fma(5. / 6, e1, -1. / 3 * e0), p1 = fma(2, e2, e1), p2 = fma(4, e2, -e3);
  const double numerator = fma(twice_j2, fma(j0, p1, j1 * p0), both * p2);
  const double denominator = fma(twice_j2, fma(1. / 6, j1, j0), both);
  return fma(from_left ? 1. / 6 : -1. / 6, numerator / denominator, from_left ? d2 : d3);
}

/// Computes rate = -v . grad q; `velocity[d]` and `rate` are indexed by slots; q needs three ghosts.
template <int Dim>
EULASTIC_INLINE void advection_rate(const Batch &batch, ConstView q, const double *const *velocity,
                                    const double *inverse_spacing, double epsilon, double *rate) noexcept {
  const double *u = velocity[0], *v = velocity[1], *w = velocity[Dim == 3 ? 2 : 0];
  const double ix = inverse_spacing[0], iy = inverse_spacing[1], iz = inverse_spacing[2];
  for_points(batch, q, [=](std::ptrdiff_t o, int i) EULASTIC_BODY {
    const double *centre = q.origin + o;
    double sum = u[i] * ix * weno5_difference(centre, 1, u[i], epsilon);
    sum = fma(v[i] * iy, weno5_difference(centre, q.sy, v[i], epsilon), sum);
    if constexpr (Dim == 3) sum = fma(w[i] * iz, weno5_difference(centre, q.sz, w[i], epsilon), sum);
    rate[i] = -sum;
  });
}

/// Position of a direction in the sum over directions: the first one sets the rate, the last one changes its sign.
enum class DirectionOrder { first, between, last };
constexpr DirectionOrder direction_order(int d, int dimension) {
  return d == 0 ? DirectionOrder::first : d < dimension - 1 ? DirectionOrder::between : DirectionOrder::last;
}

/// Adds the part of -v . grad q along direction d on a row; speed(i) returns that component of v.
template <class Speed>
EULASTIC_INLINE void add_advection_rate(const Segment &s, ConstView q, int d, DirectionOrder direction_order,
                                        Speed speed, double inverse_spacing, double epsilon, double *rate) noexcept {
  const double *row = q.row(s.j, s.k);
  const std::ptrdiff_t stride = q.stride(d);
  const auto each = [&](auto total) EULASTIC_BODY {
#pragma omp simd
    for (int i = s.i_begin; i < s.i_end; ++i) {
      const double along = speed(i);
      rate[i] = total(along * inverse_spacing, weno5_difference(row + i, stride, along, epsilon), rate[i]);
    }
  };
  if (direction_order == DirectionOrder::first)
    each([](double a, double b, double) EULASTIC_BODY { return a * b; });
  else if (direction_order == DirectionOrder::between)
    each([](double a, double b, double sum) EULASTIC_BODY { return fma(a, b, sum); });
  else
    each([](double a, double b, double sum) EULASTIC_BODY { return -fma(a, b, sum); });
}

/// Returns h dq/dx at q[0], upwind for the sign of `velocity`, from six of seven points at `stride`. For a negative
/// velocity it is the mirror image.
EULASTIC_INLINE double upwind5_difference(const double *q, std::ptrdiff_t stride, double velocity) noexcept {
  const std::ptrdiff_t s = velocity > 0 ? stride : -stride;
  const double sign = velocity > 0 ? 1. / 60 : -1. / 60;
  const double behind = fma(-2, q[-3 * s], fma(15, q[-2 * s], -60 * q[-s]));
  const double ahead = fma(-3, q[2 * s], fma(30, q[s], 20 * q[0]));
  return sign * (behind + ahead);
}

}  // namespace eulastic::kernels
