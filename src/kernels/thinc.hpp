// THINC/WLIC: the flux of a solid fraction through a face, and the interface normal it needs.
//
// In the upwind cell, across direction d, phi is a tanh of fixed steepness: THINC (Xiao, Honma & Kono, Int. J. Numer.
// Meth. Fluids 48, 2005). Weighted with the interface normal against a uniform cell: WLIC (Yokoi, JCP 226, 2007).
#pragma once

#include "grid/segment.hpp"
#include "kernels/exp_log.hpp"

#include <cmath>

namespace eulastic::kernels {

/// phi closer to 0 or 1 is rounded.
inline constexpr double fraction_epsilon = 1e-13;

#ifndef THINC_BETA
#define THINC_BETA 3.5
#endif
#ifndef THINC_EPS
#define THINC_EPS 1e-8
#endif
#ifdef THINC_SW
EULASTIC_INLINE double thinc_flux(double phi, double slope, double courant) noexcept {
  const double beta = fma(THINC_BETA, __builtin_fabs(slope), 0.01);
  const double e = exp(beta), inv = 1 / e, width = e - inv;
  const double sharp = __builtin_copysign(beta, slope);
  const double a = exp(sharp * fma(2, phi, -1));
  const double b = exp(beta * (1 - courant));
  const double ratio = a * width * b / fma(b * b, a - inv, e - a);
  double flux = 0.5 * (courant + log(ratio) / sharp);
  const double least = courant - (1 - phi);
  const double lo = least > 0 ? least : 0, hi = courant < phi ? courant : phi;
  const double edge = slope > 0 ? hi : lo;
  flux = phi < THINC_EPS ? edge : 1 - phi < THINC_EPS ? edge : flux;
  flux = flux < lo ? lo : flux;
  flux = flux > hi ? hi : flux;
  flux = phi == 0 ? 0 : phi == 1 ? courant : flux;
  return flux;
}
#else
EULASTIC_INLINE double thinc_flux(double phi, double slope, double courant) noexcept {
  constexpr double beta = THINC_BETA;
  const double e = std::exp(beta), inv = std::exp(-beta), width = e - inv;
  const double sharp = __builtin_copysign(beta, slope);
  const double a = exp(sharp * fma(2, phi, -1));
  const double b = exp(beta * (1 - courant));
  const double ratio = a * width * b / fma(b * b, a - inv, e - a);
  double flux = 0.5 * (courant + __builtin_copysign(1 / beta, slope) * log(ratio));
  const double least = courant - (1 - phi);
  const double lo = least > 0 ? least : 0, hi = courant < phi ? courant : phi;
  const double edge = slope > 0 ? hi : lo;
  flux = phi < THINC_EPS ? edge : 1 - phi < THINC_EPS ? edge : flux;
  flux = flux < lo ? lo : flux;
  flux = flux > hi ? hi : flux;
  const double w = __builtin_fabs(slope), uniform = courant * phi;
  flux = fma(w, flux - uniform, uniform);
  flux = phi == 0 ? 0 : phi == 1 ? courant : flux;
  return flux;
}
#endif

/// Undivided central difference of phi along `a`, averaged 1-2-1 across `b` (and `c`).
template <int Dim>
EULASTIC_INLINE double normal_component(const double *q, std::ptrdiff_t a, std::ptrdiff_t b, std::ptrdiff_t c) noexcept {
  const auto difference = [=](std::ptrdiff_t at) { return q[at + a] - q[at - a]; };
  if constexpr (Dim == 2) return fma(2, difference(0), difference(-b) + difference(b));
  const double corners = (difference(-b - c) + difference(b - c)) + (difference(-b + c) + difference(b + c));
  const double sides = (difference(-b) + difference(b)) + (difference(-c) + difference(c));
  return fma(4, difference(0), fma(2, sides, corners));
}

/// slope = n_d/(|n_x| + |n_y| + |n_z|), 0 where phi is uniform; `stride` of direction d first, then the others.
template <int Dim>
EULASTIC_INLINE void interface_slope(const Segment &s, ConstView phi, const std::ptrdiff_t *stride, double *out) noexcept {
  const double *q = phi.row(s.j, s.k);
  const std::ptrdiff_t a = stride[0], b = stride[1], c = stride[2];
#pragma omp simd
  for (int i = s.i_begin; i < s.i_end; ++i) {
    const double na = normal_component<Dim>(q + i, a, b, c), nb = normal_component<Dim>(q + i, b, a, c);
#ifdef THINC_SW
    double sum = fma(na, na, nb * nb);
#else
    double sum = __builtin_fabs(na) + __builtin_fabs(nb);
#endif
    if constexpr (Dim == 3) {
      const double nc = normal_component<Dim>(q + i, c, a, b);
#ifdef THINC_SW
      sum = fma(nc, nc, sum);
#else
      sum += __builtin_fabs(nc);
#endif
    }
#ifdef THINC_SW
    sum = __builtin_sqrt(sum);
#endif
    out[i] = sum > 0 ? na / sum : 0;
  }
}

inline constexpr double interface_flux_flops = 2 * exp_flops + log_flops + 26, apply_flux_flops = 7;
constexpr double slope_flops(int dimension) { return dimension == 2 ? 2 * 6 + 2 : 3 * 20 + 3; }

/// Signed volume through the low faces of segment s, in cells. `rate` = dt/h; slope and phi are read at the upwind
/// cell, `step` below or at the face.
EULASTIC_INLINE void interface_flux(const Segment &s, ConstView phi, ConstView slope, ConstView velocity,
                                    std::ptrdiff_t step, double rate, double *flux) noexcept {
  const double *q = phi.row(s.j, s.k), *n = slope.row(s.j, s.k), *u = velocity.row(s.j, s.k);
#pragma omp simd
  for (int i = s.i_begin; i < s.i_end; ++i) {
    const double courant = u[i] * rate;
    const double q_low = q[i - step], n_low = n[i - step], q_high = q[i], n_high = -n[i];
    const bool upward = courant > 0;
    const double volume = thinc_flux(upward ? q_low : q_high, upward ? n_low : n_high, __builtin_fabs(courant));
    flux[i] = __builtin_copysign(volume, courant);
  }
}

/// phi -= difference of fluxes - solid (difference of the Courant numbers); what round-off leaves of 0 and 1 is
/// rounded.
EULASTIC_INLINE void apply_flux(const Segment &s, ConstView flux, ConstView velocity, ConstView solid,
                                std::ptrdiff_t step, double rate, double *phi) noexcept {
  const double *f = flux.row(s.j, s.k), *u = velocity.row(s.j, s.k), *c = solid.row(s.j, s.k);
#pragma omp simd
  for (int i = s.i_begin; i < s.i_end; ++i) {
    const double dilation = c[i] * (u[i + step] * rate - u[i] * rate);
    const double q = phi[i] + (dilation - (f[i + step] - f[i]));
    phi[i] = q < fraction_epsilon ? 0 : 1 - q < fraction_epsilon ? 1 : q;
  }
}

}  // namespace eulastic::kernels
