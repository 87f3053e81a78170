// THINC/SW: the flux of a solid fraction through a face, and the interface normal that sets its sharpness.
//
// Across direction d, phi in the upwind cell is (1 + alpha tanh(beta (x - x0)))/2 with a steepness beta that follows
// the normal: 2.3 where the interface faces d, towards 0 (uniform) where it runs along d. Xiao, Honma & Kono, Int. J.
// Numer. Meth. Fluids 48 (2005); Xiao, Ii & Chen, J. Comput. Phys. 230 (2011).
#pragma once

#include "grid/segment.hpp"
#include "kernels/exp_log.hpp"

namespace eulastic::kernels {

inline constexpr double steepness = 2.3;       ///< beta per component of the unit normal
inline constexpr double steepness_min = 0.01;  ///< below it the flux is blended with the uniform one
inline constexpr double nearly_pure = 1e-5;    ///< cells this close to 0 or 1 have all of their rest on one side
inline constexpr double round_off = 1e-13;     ///< what may be left of 0 and 1 when it should be nothing

inline constexpr double thinc_flux_flops = 3 * exp_flops + log_flops + 32, interface_flux_flops = thinc_flux_flops + 1;
inline constexpr double apply_flux_flops = 8, interface_slope_flops_2d = 15, interface_slope_flops_3d = 70;

/// Volume that leaves a cell through one face, in cells. `slope` is the component of the unit normal towards the face,
/// positive where phi grows; `courant` = |u| dt/h. With A = exp(alpha beta (2 phi - 1)), b = exp(beta (1 - courant)):
///   F = (courant + alpha/beta ln(A (e^beta - e^-beta) b/(b^2 (A - e^-beta) + e^beta - A)))/2.
/// Nearly pure cells take the limit of an infinite beta: without tails the band stays thin, and nothing is lost.
EULASTIC_INLINE double thinc_flux(double phi, double slope, double courant) noexcept {
  const double steep = steepness * __builtin_fabs(slope);
  const double beta = steep > steepness_min ? steep : steepness_min;
  const double sharp = __builtin_copysign(beta, slope);
  const double most = exp(beta), least = 1 / most, a = exp(sharp * fma(2, phi, -1)), b = exp(beta * (1 - courant));
  const double ratio = a * (most - least) * b / fma(b * b, a - least, most - a);
  const double smooth = 0.5 * (courant + log(ratio) / sharp);
  const double fluid = courant - (1 - phi);  // what remains when all fluid leaves first
  const double low = fluid > 0 ? fluid : 0, high = courant < phi ? courant : phi;
  const double step = slope > 0 ? high : low;
  const double tanh = phi < nearly_pure ? step : 1 - phi < nearly_pure ? step : smooth;
  const double uniform = courant * phi;
  const double flux = steep < steepness_min ? fma(steep / steepness_min, tanh - uniform, uniform) : tanh;
  const double above = flux > low ? flux : low;
  return above < high ? above : high;
}

/// Undivided central difference of phi along a, averaged 1-2-1 across b (and c).
template <int Dim>
EULASTIC_INLINE double normal_component(const double *q, std::ptrdiff_t a, std::ptrdiff_t b,
                                        std::ptrdiff_t c) noexcept {
  const auto difference = [q, a](std::ptrdiff_t at) { return q[at + a] - q[at - a]; };
  if constexpr (Dim == 2) return fma(2, difference(0), difference(-b) + difference(b));
  const double corners = (difference(-b - c) + difference(b - c)) + (difference(-b + c) + difference(b + c));
  const double sides = (difference(-b) + difference(b)) + (difference(-c) + difference(c));
  return fma(4, difference(0), fma(2, sides, corners));
}

/// Component along the first of the directions `stride` of the unit normal towards larger phi, in cells of unit size;
/// 0 where phi is uniform.
template <int Dim>
EULASTIC_INLINE void interface_slope(const Segment &s, ConstView phi, const std::ptrdiff_t *stride,
                                     double *slope) noexcept {
  const double *q = phi.row(s.j, s.k);
  const std::ptrdiff_t a = stride[0], b = stride[1], c = stride[2];
#pragma omp simd
  for (int i = s.i_begin; i < s.i_end; ++i) {
    const double na = normal_component<Dim>(q + i, a, b, c), nb = normal_component<Dim>(q + i, b, a, c);
    double square = fma(na, na, nb * nb);
    if constexpr (Dim == 3) {
      const double nc = normal_component<Dim>(q + i, c, a, b);
      square = fma(nc, nc, square);
    }
    slope[i] = square > 0 ? na / __builtin_sqrt(square) : 0;
  }
}

/// Signed volume through the low faces of segment s, in cells; `rate` = dt/h. phi and slope are read at the face and
/// `step` below it.
EULASTIC_INLINE void interface_flux(const Segment &s, ConstView phi, ConstView slope, ConstView velocity,
                                    std::ptrdiff_t step, double rate, double *flux) noexcept {
  const double *q = phi.row(s.j, s.k), *n = slope.row(s.j, s.k), *u = velocity.row(s.j, s.k);
#pragma omp simd
  for (int i = s.i_begin; i < s.i_end; ++i) {
    const double courant = u[i] * rate;
    const double below = q[i - step], here = q[i], slope_below = n[i - step], slope_here = -n[i];
    const bool upward = courant > 0;
    const double volume = thinc_flux(upward ? below : here, upward ? slope_below : slope_here, __builtin_fabs(courant));
    flux[i] = __builtin_copysign(volume, courant);
  }
}

/// phi -= difference of the fluxes - solid * difference of the Courant numbers; full cells between full cells and
/// empty ones between empty ones keep their value exactly.
EULASTIC_INLINE void apply_flux(const Segment &s, ConstView flux, ConstView velocity, ConstView solid,
                                std::ptrdiff_t step, double rate, double *phi) noexcept {
  const double *f = flux.row(s.j, s.k), *u = velocity.row(s.j, s.k), *c = solid.row(s.j, s.k);
#pragma omp simd
  for (int i = s.i_begin; i < s.i_end; ++i) {
    const double dilation = c[i] * (u[i + step] * rate - u[i] * rate);
    const double q = phi[i] + (dilation - (f[i + step] - f[i]));
    phi[i] = q < round_off ? 0 : 1 - q < round_off ? 1 : q;
  }
}

}  // namespace eulastic::kernels
