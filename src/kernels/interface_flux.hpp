// One directional split of the transport of a solid fraction: fluxes through faces and the update of phi
// (docs/method.md, section 6).
#pragma once

#include "grid/segment.hpp"
#include "kernels/interface_normal.hpp"
#include "kernels/plane.hpp"

namespace eulastic::kernels {

inline constexpr double round_off = 1e-13;  ///< phi within this distance of 0 or 1 is set to 0 or 1
inline constexpr double uniform_flux_flops = 2, apply_flux_flops = 8;
inline constexpr double mixed_flux_flops_2d =
    interface_normal_flops_2d + plane_constant_flops_2d + 2 * plane_flux_flops_2d;
inline constexpr double mixed_flux_flops_3d =
    interface_normal_flops_3d + plane_constant_flops_3d + 2 * plane_flux_flops_3d;

/// A list of mixed cells, 0 < phi < 1. A row of the interface band has only two or three of them, so that they are
/// collected for long loops.
struct MixedCells {
  static constexpr int capacity = 256;
  std::ptrdiff_t at[capacity];         ///< offset from the origin of phi and of every field with the same layout
  bool low[capacity], high[capacity];  ///< whether the flux through the low and the high face is needed
  int count = 0;
};

/// Writes the signed volume through the low faces of segment s, in cells, for upwind cells that are full, empty or
/// without a normal. `rate` = dt/h. Reads phi at the cell of the face and `step` below it.
EULASTIC_INLINE void uniform_flux(const Segment &s, ConstView phi, ConstView velocity, std::ptrdiff_t step, double rate,
                                  double *flux) noexcept {
  const double *q = phi.row(s.j, s.k), *u = velocity.row(s.j, s.k);
#pragma omp simd
  for (int i = s.i_begin; i < s.i_end; ++i) {
    const double courant = u[i] * rate;
    flux[i] = courant * (courant > 0 ? q[i - step] : q[i]);
  }
}

/// Writes the volumes that leave the mixed cells through their faces in the first of the directions `stride`. Reads phi
/// in all neighbours and the velocity on both faces.
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

/// Updates phi -= (difference of the fluxes) - solid (difference of the Courant numbers). Full cells between full cells
/// and empty cells between empty cells keep their value exactly. `solid` is 1 where phi exceeded 1/2 before the first
/// split, else 0.
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
