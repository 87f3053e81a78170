// One stage of RKL2 in increments, updated in place with three reads and one write (docs/method.md, section 5).
#pragma once

#include "kernels/momentum.hpp"

namespace eulastic::kernels {

/// Coefficients of W_j = mu W_j-1 + nu W_j-2 + mu~ dt (viscosity L W_j-1 + c_j-1 dt M_1) + (mu~ + gamma~) dt M_0.
struct RklStage {
  double mu, nu, viscous, rate, slope;  ///< the last three: mu~ dt viscosity, (mu~ + gamma~) dt, mu~ dt c_j-1 dt
};

inline constexpr double rkl_stage_flops_2d = 12, rkl_stage_flops_3d = 16;

/// Replaces W_j-2 in `before` by W_j. M_1 = slope is read if WithSlope. force(i) returns L W_j-1 at offset i of the
/// row.
template <bool WithSlope, class Force>
EULASTIC_INLINE void rkl_stage(const Segment &s, RklStage c, ConstView now, ConstView rate, ConstView slope,
                               const Force &force, View before) noexcept {
  const double *w = now.row(s.j, s.k), *m = rate.row(s.j, s.k), *m1 = WithSlope ? slope.row(s.j, s.k) : m;
  double *out = before.row(s.j, s.k);
#pragma omp simd
  for (int i = s.i_begin; i < s.i_end; ++i) {
    double sum = c.nu * out[i];
    sum = fma(c.mu, w[i], sum);
    sum = fma(c.rate, m[i], sum);
    sum = WithSlope ? fma(c.slope, m1[i], sum) : sum + 0.0;  // + 0.0 gives the bits of a slope of 0, also for -0
    out[i] = fma(c.viscous, force(i), sum);
  }
}

/// The viscous force at constant viscosity.
template <int Dim>
struct RowLaplacian {
  const double *w;
  std::ptrdiff_t sy, sz;
  InverseSquares h;

  RowLaplacian(ConstView q, const Segment &s, InverseSquares inverse)
      : w(q.row(s.j, s.k)), sy(q.sy), sz(q.sz), h(inverse) {}
  EULASTIC_BODY double operator()(std::ptrdiff_t i) const noexcept { return laplacian<Dim>(w + i, sy, sz, h); }
};

}  // namespace eulastic::kernels
