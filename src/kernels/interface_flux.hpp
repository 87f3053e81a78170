// One direction of the transport of a solid fraction by planes: fluxes through faces, and what they leave of phi.
#pragma once

#include "grid/segment.hpp"
#include "kernels/interface_normal.hpp"
#include "kernels/plane.hpp"

namespace eulastic::kernels {

inline constexpr double round_off = 1e-13;  ///< what may be left of 0 and 1 when it should be nothing
inline constexpr double uniform_flux_flops = 2, apply_flux_flops = 8;
inline constexpr double mixed_flux_flops_2d =
    interface_normal_flops_2d + plane_constant_flops_2d + 2 * plane_flux_flops_2d;
inline constexpr double mixed_flux_flops_3d =
    interface_normal_flops_3d + plane_constant_flops_3d + 2 * plane_flux_flops_3d;

/// A list of mixed cells, 0 < phi < 1, that are worked on in loops as long as the list: in a row of the interface band
/// there are two or three.
struct MixedCells {
  static constexpr int capacity = 256;
  std::ptrdiff_t at[capacity];         ///< offset from the origin of phi and of every field like it
  bool low[capacity], high[capacity];  ///< whether the flux through that face is wanted
  int count = 0;
};

/// Signed volume through the low faces of segment s, in cells, where the upwind cell is full, empty, or has no normal;
/// `rate` = dt/h. phi is read at the face and `step` below it.
EULASTIC_INLINE void uniform_flux(const Segment &s, ConstView phi, ConstView velocity, std::ptrdiff_t step, double rate,
                                  double *flux) noexcept {
  const double *q = phi.row(s.j, s.k), *u = velocity.row(s.j, s.k);
#pragma omp simd
  for (int i = s.i_begin; i < s.i_end; ++i) {
    const double courant = u[i] * rate;
    flux[i] = courant * (courant > 0 ? q[i - step] : q[i]);
  }
}

/// What leaves the mixed cells through their faces in the first of the directions `stride`. phi is read in all
/// neighbours, the velocity at both faces.
template <int Dim>
EULASTIC_INLINE void mixed_flux(const MixedCells &cells, const double *phi, const std::ptrdiff_t *stride,
                                const double *velocity, double rate, double *flux) noexcept {
  constexpr int capacity = MixedCells::capacity;
  double na[capacity], mb[capacity], mc[capacity], alpha[capacity], low[capacity], high[capacity];
  const std::ptrdiff_t a = stride[0], b = stride[1], c = stride[2];
  const std::ptrdiff_t *const at = cells.at;
  const int count = cells.count;
#pragma omp simd
  for (int n = 0; n < count; ++n) {
    const InterfaceNormal normal = interface_normal<Dim>(phi + at[n], a, b, c);
    na[n] = normal.a;
    mb[n] = __builtin_fabs(normal.b);
    mc[n] = __builtin_fabs(normal.c);
  }
#pragma omp simd
  for (int n = 0; n < count; ++n) alpha[n] = plane_constant<Dim>(phi[at[n]], __builtin_fabs(na[n]), mb[n], mc[n]);
#pragma omp simd
  for (int n = 0; n < count; ++n) {
    const double q = phi[at[n]], down = __builtin_fabs(velocity[at[n]] * rate);
    const double up = __builtin_fabs(velocity[at[n] + a] * rate);
    low[n] = plane_flux<Dim>(q, alpha[n], -na[n], mb[n], mc[n], down);
    high[n] = plane_flux<Dim>(q, alpha[n], na[n], mb[n], mc[n], up);
  }
  for (int n = 0; n < count; ++n) {
    if (cells.low[n] && velocity[at[n]] * rate < 0) flux[at[n]] = -low[n];
    if (cells.high[n] && velocity[at[n] + a] * rate > 0) flux[at[n] + a] = high[n];
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
