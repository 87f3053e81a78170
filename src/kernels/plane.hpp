// A plane that cuts a unit cell: the solid is m.x < alpha, with 0 <= x <= 1 from the corner that lies deepest in the
// solid, and m >= 0 with the sum 1. Computes the volume below the plane, alpha from the volume, and the volume that
// leaves through a face.
//
// Scardovelli & Zaleski, J. Comput. Phys. 164 (2000); docs/method.md, section 6. Because V(1 - alpha) = 1 - V(alpha),
// all is computed for the smaller part of the cell, where no terms cancel, however small a component of m is.
#pragma once

#include "kernels/interface_normal.hpp"
#include "kernels/isa.hpp"

#include <cstdint>

namespace eulastic::kernels {

inline constexpr double cube_root_flops = 17;

/// Returns x^(1/3) for normal x > 0 with a relative error below 2e-14.
EULASTIC_INLINE double cube_root(double x) noexcept {
  constexpr std::uint64_t two_52 = 0x4330000000000000;
  const double upper = __builtin_bit_cast(double, (__builtin_bit_cast(std::uint64_t, x) >> 32) | two_52) - 0x1p52;
  const double third = fma(upper, 1. / 3, 715094163 + 0x1p52);  // the last bits hold the nearest integer
  double t = __builtin_bit_cast(double, __builtin_bit_cast(std::uint64_t, third) << 32);
  for (int step = 0; step < 2; ++step) {
    const double cube = t * t * t;
    t *= fma(2, x, cube) / fma(2, cube, x);
  }
  return t;
}

inline constexpr double plane_constant_flops_2d = 10, plane_constant_flops_3d = 95 + cube_root_flops;
inline constexpr double plane_flux_flops_2d = 25, plane_flux_flops_3d = 60;

EULASTIC_INLINE double smaller(double a, double b) noexcept { return a < b ? a : b; }
EULASTIC_INLINE double larger(double a, double b) noexcept { return a > b ? a : b; }

/// Three components of m in ascending order; 2-D uses the first and the last.
struct Ascending {
  double m1, m2, m3;
};
template <int Dim>
EULASTIC_INLINE Ascending ascending(double a, double b, double c) noexcept {
  constexpr double least = 1e-40;  // replaces 0, so that no divisor is 0 and no product underflows
  const double low = smaller(a, b), high = larger(a, b);
  if constexpr (Dim == 2) return {larger(low, least), 0, high};
  return {larger(smaller(low, c), least), larger(larger(low, smaller(high, c)), least), larger(high, c)};
}

/// Returns the volume below the plane m.x = alpha, for any m >= 0 with a sum > 0. 2-D ignores c.
template <int Dim>
EULASTIC_INLINE double volume_below(double alpha, double a, double b, double c) noexcept {
  const double scale = 1 / (Dim == 2 ? a + b : a + b + c), at = alpha * scale;
  const auto [m1, m2, m3] = ascending<Dim>(a * scale, b * scale, c * scale);
  const double inside = smaller(larger(at, 0), 1), t = smaller(inside, 1 - inside);
  double volume;
  if constexpr (Dim == 2) {
    const double inverse = 0.5 / (m1 * m3);
    volume = t < m1 ? t * t * inverse : (2 * m1) * inverse * fma(-0.5, m1, t);
  } else {
    const double m12 = m1 + m2, inverse = 1 / (6 * (m1 * m2) * m3);
    const double past2 = larger(t - m2, 0), past3 = larger(t - m3, 0);
    const double cubes = fma(past2 * past2, past2, past3 * past3 * past3);
    const double middle = fma(m1, fma(3 * t, t - m1, m1 * m1), -cubes) * inverse;
    const double linear = fma(-0.5, m12, t) * ((6 * m1 * m2) * inverse);
    volume = t < m1 ? t * t * t * inverse : t < m12 ? middle : linear;
  }
  return inside > 0.5 ? 1 - volume : volume;
}

/// Returns alpha of the plane with the volume phi, 0 <= phi <= 1, below it, to 1e-14. The sum of m is 1. 2-D ignores c.
template <int Dim>
EULASTIC_INLINE double plane_constant(double phi, double a, double b, double c) noexcept {
  const auto [m1, m2, m3] = ascending<Dim>(a, b, c);
  const double w = smaller(phi, 1 - phi);
  double t;
  if constexpr (Dim == 2) {
    const double linear = fma(m3, w, 0.5 * m1);
    t = linear < m1 ? __builtin_sqrt(2 * m1 * m3 * w) : linear;
  } else {
    // Newton's method for the middle piece of V. It starts from the root without the cubes, which is never too large.
    const double m12 = m1 + m2, most = smaller(m12, 0.5), six_w = 6 * m2 * m3 * w;
    const double linear = fma(m3, w, 0.5 * m12);
    double middle = 0.5 * (m1 + __builtin_sqrt(larger(fma(m1, -m1, 4 * six_w) * (1. / 3), 0)));
#pragma GCC unroll 3
    for (int step = 0; step < 3; ++step) {
      middle = smaller(middle, most);
      const double past2 = larger(middle - m2, 0), past3 = larger(middle - m3, 0);
      const double cubes = fma(past2 * past2, past2, past3 * past3 * past3);
      const double value = fma(m1, fma(3 * middle, middle - m1, fma(m1, m1, -six_w)), -cubes);
      const double slope = fma(m1, fma(2, middle, -m1), -fma(past2, past2, past3 * past3));
      middle -= value / (3 * slope);
    }
    middle = smaller(middle, most);
    const double corner = cube_root(six_w * m1);
    t = six_w < m1 * m1 ? corner : linear < m12 ? middle : linear;
  }
  return phi > 0.5 ? 1 - t : t;
}

/// Returns the derivative of the volume below the plane with respect to alpha; times m_d it is the area of the plane
/// projected along d, in faces of the cell. The sum of m is 1. 2-D ignores c.
template <int Dim>
EULASTIC_INLINE double volume_slope(double alpha, double a, double b, double c) noexcept {
  const auto [m1, m2, m3] = ascending<Dim>(a, b, c);
  const double t = smaller(alpha, 1 - alpha);
  if constexpr (Dim == 2) return t < m1 ? t / (m1 * m3) : 1 / m3;
  const double m12 = m1 + m2, past2 = larger(t - m2, 0), past3 = larger(t - m3, 0), twice = 2 * (m1 * m2) * m3;
  const double middle = fma(m1, fma(2, t, -m1), -fma(past2, past2, past3 * past3)) / twice;
  return t < m1 ? t * t / twice : t < m12 ? middle : 1 / m3;
}

/// Returns the volume that leaves the cell through one face, in cells, at the Courant number 0 <= courant <= 1.
/// `towards` is the component of the normal towards that face, positive where phi grows; `across1` and `across2` are
/// the sizes of the other components. If all are 0, the result is courant phi.
template <int Dim>
EULASTIC_INLINE double plane_flux(double phi, double alpha, double towards, double across1, double across2,
                                  double courant) noexcept {
  const double m = __builtin_fabs(towards), alpha_before = towards > 0 ? alpha : fma(m, courant - 1, alpha);
  const double volume = courant * volume_below<Dim>(alpha_before, m * courant, across1, across2);
  const double flux = m + across1 + across2 > 0 ? volume : courant * phi;
  return smaller(larger(flux, larger(courant - (1 - phi), 0)), smaller(courant, phi));
}

/// Returns the area of the plane in a cell with 0 < phi < 1. `face`: areas of the cell's faces across every direction.
template <int Dim>
EULASTIC_INLINE double plane_area(const double *q, const std::ptrdiff_t *stride, const double *face) noexcept {
  const InterfaceNormal n = interface_normal<Dim>(q, stride[0], stride[1], stride[2]);
  const double m[3] = {__builtin_fabs(n.a), __builtin_fabs(n.b), __builtin_fabs(n.c)};
  if (!(m[0] + m[1] + m[2] > 0)) return 0;
  const double slope = volume_slope<Dim>(plane_constant<Dim>(*q, m[0], m[1], m[2]), m[0], m[1], m[2]);
  double square = 0;
  for (int d = 0; d < Dim; ++d) square = fma(m[d] * face[d], m[d] * face[d], square);
  return slope * __builtin_sqrt(square);
}

}  // namespace eulastic::kernels
