// Bending of a membrane at one point, from a smoothed solid fraction psi around it: the curvatures of the surface and
// the tangential gradient of the curvature (docs/method.md, section 18). Mirrored neighbours give the same bits.
#pragma once

#include "kernels/stencils.hpp"

namespace eulastic::kernels {

/// Returns the quantile of the normal distribution of 1/2 - psi, within .0007 for .00003 < psi < .99997. It is nearly
/// linear in the distance from the surface and positive outside, so that its differences are accurate; the curvature of
/// a level surface is the same for any function of psi.
EULASTIC_INLINE double surface_level(double psi) noexcept {
  constexpr double most = 0.49997;
  const double offset = 0.5 - psi, q = offset > most ? most : offset < -most ? -most : offset, r = q * q;
  constexpr double top[5] = {2.5083781391835727, -32.714879959659854, 153.95373578467806, -303.4151611935878,
                             202.00843306993525},
                   bottom[4] = {-14.049705712795657, 72.99713102775232, -165.58470644867114, 137.565900413665};
  const double numerator = fma(r, fma(r, fma(r, fma(r, top[4], top[3]), top[2]), top[1]), top[0]);
  const double denominator = fma(r, fma(r, fma(r, fma(r, bottom[3], bottom[2]), bottom[1]), bottom[0]), 1);
  return q * numerator / denominator;
}

/// Curvatures of a surface at one point.
struct Curvatures {
  double sum = 0, product = 0;  ///< of the principal curvatures, positive for a ball; 2-D: the second one is 0
};

/// Returns the curvatures of the level surface 0 of q, which lies near this point. `steepest` is the largest curvature
/// that is not limited.
template <int Dim>
EULASTIC_INLINE Curvatures surface_curvatures(const double *q, const std::ptrdiff_t *stride, const double *inverse,
                                              double steepest) noexcept {
  double g[3] = {}, second[3] = {}, mixed[3] = {};  // mixed[c]: derivative in the other two directions
  for (int d = 0; d < Dim; ++d) {
    const double up = q[stride[d]], down = q[-stride[d]];
    g[d] = 0.5 * inverse[d] * (up - down);
    second[d] = inverse[d] * inverse[d] * ((up + down) - 2 * *q);
  }
  for (int c = Dim == 2 ? 2 : 0; c < 3; ++c) {
    const int a = (c + 1) % 3, b = (c + 2) % 3;
    mixed[c] = 0.25 * inverse[a] * inverse[b] *
               ((q[stride[a] + stride[b]] + q[-stride[a] - stride[b]]) -
                (q[stride[a] - stride[b]] + q[stride[b] - stride[a]]));
  }
  const double xx = g[0] * g[0], yy = g[1] * g[1], zz = g[2] * g[2], square = (xx + yy) + zz;
  if (!(square > 0)) return {};
  const double size = __builtin_sqrt(square), distance = *q / size;
  const double across = (second[0] * (yy + zz) + second[1] * (xx + zz)) + second[2] * (xx + yy);
  const double cross_terms = (mixed[2] * (g[0] * g[1]) + mixed[1] * (g[0] * g[2])) + mixed[0] * (g[1] * g[2]);
  const double sum = (across - 2 * cross_terms) / (square * size);
  double product = 0;
  if constexpr (Dim == 3) {
    const auto plane = [&](int a, int b, int c) { return second[b] * second[c] - mixed[a] * mixed[a]; };
    const auto pair = [&](int a, int b, int c) { return (g[a] * g[b]) * (mixed[b] * mixed[a] - mixed[c] * second[c]); };
    const double straight = (xx * plane(0, 1, 2) + yy * plane(1, 2, 0)) + zz * plane(2, 0, 1);
    product = (straight + 2 * ((pair(0, 1, 2) + pair(0, 2, 1)) + pair(1, 2, 0))) / (square * square);
  }
  // The curvatures of parallel surfaces: k becomes k/(1 - k d) at the distance d.
  constexpr double least = 0.3;
  const double ratio = (1 - sum * distance) + product * (distance * distance);
  const double scale = 1 / (ratio > least ? ratio : least), most = (Dim - 1) * steepest;
  const double at_surface = scale * (sum - 2 * product * distance);
  Curvatures limited;
  limited.sum = at_surface > most ? most : at_surface < -most ? -most : at_surface;
  const double equal = 0.25 * limited.sum * limited.sum, lowest = -steepest * steepest, k = scale * product;
  if constexpr (Dim == 3) limited.product = k > equal ? equal : k < lowest ? lowest : k;
  return limited;
}

/// Returns the component along `a` of delta (1 - n n) grad(curvature) on the face between q and the cell before it
/// along `a`; 0 where a cell of the stencil has no delta. All three fields have the same strides.
template <int Dim>
EULASTIC_INLINE double curvature_flux(const double *level, const double *curvature, const double *delta, int a,
                                      const std::ptrdiff_t *stride, const double *inverse) noexcept {
  const std::ptrdiff_t s = stride[a];
  bool known = delta[0] > 0 && delta[-s] > 0;
  double n[Dim], slope[Dim];
  const auto face = [&](const double *v, int d) {
    const std::ptrdiff_t t = stride[d];
    return 0.25 * inverse[d] * ((v[t] - v[-t]) + (v[t - s] - v[-t - s]));
  };
  double square = 0;
  for (int e = 0; e < Dim; ++e) {
    const int d = (a + e) % Dim;
    const std::ptrdiff_t t = stride[d];
    if (e == 0) {
      n[0] = inverse[d] * (level[0] - level[-s]);
      slope[0] = inverse[d] * (curvature[0] - curvature[-s]);
    } else {
      known = known && delta[t] > 0 && delta[-t] > 0 && delta[t - s] > 0 && delta[-t - s] > 0;
      n[e] = face(level, d);
      slope[e] = face(curvature, d);
    }
  }
  double along = n[0] * slope[0];
  square = n[0] * n[0];
  double rest = n[1] * slope[1], rest_square = n[1] * n[1];
  if constexpr (Dim == 3) {
    rest += n[2] * slope[2];
    rest_square += n[2] * n[2];
  }
  along += rest;
  square += rest_square;
  return known && square > 0 ? 0.5 * (delta[0] + delta[-s]) * (slope[0] - n[0] * along / square) : 0;
}

/// Returns the terms of (27), over E_b, that do not contain derivatives of the curvature.
EULASTIC_INLINE double bending_pressure(const Curvatures &k, double spontaneous) noexcept {
  return (k.sum - spontaneous) * (0.5 * k.sum * (k.sum + spontaneous) - 2 * k.product);
}

}  // namespace eulastic::kernels
