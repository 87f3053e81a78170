// One stage of RKL2 in increments, updated in place: three reads, one write.
#pragma once

#include "kernels/momentum.hpp"

namespace eulastic::kernels {

/// W_j = mu W_j-1 + nu W_j-2 + mu~ dt (viscosity lap W_j-1 + c_j-1 dt M_1) + (mu~ + gamma~) dt M_0.
struct RklStage {
  double mu, nu, viscous, rate, slope;  ///< mu~ dt viscosity, (mu~ + gamma~) dt, mu~ dt c_j-1 dt
};

inline constexpr double rkl_stage_flops_2d = 12, rkl_stage_flops_3d = 16;

/// `before` holds W_j-2 and gets W_j. M_1 = slope is read if WithSlope.
template <int Dim, bool WithSlope>
EULASTIC_INLINE void rkl_stage(const Segment &s, RklStage c, ConstView now, ConstView rate, ConstView slope,
                               InverseSquares h, View before) noexcept {
  const double *w = now.row(s.j, s.k), *m = rate.row(s.j, s.k), *m1 = WithSlope ? slope.row(s.j, s.k) : m;
  double *out = before.row(s.j, s.k);
  const std::ptrdiff_t sy = now.sy, sz = now.sz;
#pragma omp simd
  for (int i = s.i_begin; i < s.i_end; ++i) {
    double sum = c.nu * out[i];
    sum = fma(c.mu, w[i], sum);
    sum = fma(c.rate, m[i], sum);
    sum = WithSlope ? fma(c.slope, m1[i], sum) : sum + 0.0;  // a slope of 0: the same bits, -0 too
    out[i] = fma(c.viscous, laplacian<Dim>(w + i, sy, sz, h), sum);
  }
}

}  // namespace eulastic::kernels
