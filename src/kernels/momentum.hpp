// Central terms of second order of the momentum equation (2) on the faces of one component, added to rates by rows.
#pragma once

#include "kernels/stencils.hpp"

namespace eulastic::kernels {

inline constexpr double viscous_pressure_flops_per_direction = 6;

/// Returns the compact Laplacian of a field at q[0].
template <int Dim>
EULASTIC_INLINE double laplacian(const double *q, std::ptrdiff_t sy, std::ptrdiff_t sz, InverseSquares h) noexcept {
  const double twice = 2 * q[0];
  double sum = h.x * ((q[1] + q[-1]) - twice);
  sum = fma(h.y, (q[sy] + q[-sy]) - twice, sum);
  if constexpr (Dim == 3) sum = fma(h.z, (q[sz] + q[-sz]) - twice, sum);
  return sum;
}

/// Computes out = advection + nu lap q - (p - p[-step]) pressure_factor + force. `viscosity` = nu/h_d^2.
template <int Dim>
EULASTIC_INLINE void fluid_rate(const Segment &s, const double *advection, ConstView q, InverseSquares viscosity,
                                ConstView p, std::ptrdiff_t step, double pressure_factor, double force,
                                double *out) noexcept {
  const double *u = q.row(s.j, s.k), *pressure = p.row(s.j, s.k);
  const std::ptrdiff_t sy = q.sy, sz = q.sz;
#pragma omp simd
  for (int i = s.i_begin; i < s.i_end; ++i) {
    const double viscous = laplacian<Dim>(u + i, sy, sz, viscosity);
    out[i] = advection[i] + (fma(-pressure_factor, pressure[i] - pressure[i - step], viscous) + force);
  }
}

/// Computes out = density div v at centres.
template <int Dim>
EULASTIC_INLINE void divergence(const Segment &s, ConstView u, ConstView v, ConstView w, const double *inverse_spacing,
                                double density, double *out) noexcept {
  const double *uu = u.row(s.j, s.k), *vv = v.row(s.j, s.k), *ww = w.row(s.j, s.k);
  const double ix = density * inverse_spacing[0], iy = density * inverse_spacing[1], iz = density * inverse_spacing[2];
  const std::ptrdiff_t sy = v.sy, sz = v.sz;
#pragma omp simd
  for (int i = s.i_begin; i < s.i_end; ++i) {
    double sum = ix * (uu[i + 1] - uu[i]);
    sum = fma(iy, vv[i + sy] - vv[i], sum);
    if constexpr (Dim == 3) sum = fma(iz, ww[i + sz] - ww[i], sum);
    out[i] = sum;
  }
}

/// The increment delta p of (11), less its mean and that of p: kappa = beta^2 dt^2, g = beta^2 dt^2 gamma.
struct AcmIncrement {
  double kappa, g, inverse_dt, mean;
  EULASTIC_BODY double operator()(double divergence, double pressure) const noexcept {
    return -inverse_dt * fma(kappa, divergence, g * (pressure - mean)) - mean;
  }
};

}  // namespace eulastic::kernels
