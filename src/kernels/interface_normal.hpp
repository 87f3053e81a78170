// The normal of the interface in a cell from its 3^d neighbours, by the mixed Youngs-centred scheme (docs/method.md,
// section 6).
//
// Youngs' gradient (Numerical methods for fluid dynamics, Academic Press, 1982) is robust; the slopes of columns of
// three cells are exact for planes. The choice follows Aulisa, Manservisi, Scardovelli & Zaleski, J. Comput. Phys. 225
// (2007).
#pragma once

#include "kernels/isa.hpp"

#include <cstddef>

namespace eulastic::kernels {

inline constexpr double interface_normal_flops_2d = 30, interface_normal_flops_3d = 135;

/// The normal in cells of unit size points to larger phi and has |a| + |b| + |c| = 1; it is 0 where phi has no
/// gradient. In 2-D c = 0.
struct InterfaceNormal {
  double a, b, c;
};

/// Returns the component along a of Youngs' gradient: the undivided central difference of phi, averaged 1-2-1 across b
/// (and c).
template <int Dim>
EULASTIC_INLINE double youngs_component(const double *q, std::ptrdiff_t a, std::ptrdiff_t b,
                                        std::ptrdiff_t c) noexcept {
  const auto difference = [q, a](std::ptrdiff_t at) { return q[at + a] - q[at - a]; };
  if constexpr (Dim == 2) return fma(2, difference(0), difference(-b) + difference(b));
  const double corners = (difference(-b - c) + difference(b - c)) + (difference(-b + c) + difference(b + c));
  const double sides = (difference(-b) + difference(b)) + (difference(-c) + difference(c));
  return fma(4, difference(0), fma(2, sides, corners));
}

/// Returns the slope along b of the volume in columns of three cells along a, per cell.
EULASTIC_INLINE double column_slope(const double *q, std::ptrdiff_t a, std::ptrdiff_t b) noexcept {
  const auto column = [q, a](std::ptrdiff_t at) { return (q[at - a] + q[at + a]) + q[at]; };
  return 0.5 * (column(b) - column(-b));
}

/// Returns the normal at q; a, b, c are the strides of the directions. Of equal inclinations the first direction is
/// taken, so that mirrored neighbours give the mirrored normal with the same bits.
template <int Dim>
EULASTIC_INLINE InterfaceNormal interface_normal(const double *q, std::ptrdiff_t a, std::ptrdiff_t b,
                                                 std::ptrdiff_t c) noexcept {
  const double ga = youngs_component<Dim>(q, a, b, c), gb = youngs_component<Dim>(q, b, a, c);
  const double gc = Dim == 3 ? youngs_component<Dim>(q, c, a, b) : 0;
  const auto slope = [q](std::ptrdiff_t along, std::ptrdiff_t across) { return column_slope(q, along, across); };
  // Columns along the direction in which the surface is least inclined, among directions with a gradient.
  const double ab = slope(a, b), ac = Dim == 3 ? slope(a, c) : 0;
  const double ba = slope(b, a), bc = Dim == 3 ? slope(b, c) : 0;
  const double ca = Dim == 3 ? slope(c, a) : 0, cb = Dim == 3 ? slope(c, b) : 0;
  const auto inclination = [](double g, double s, double t) {
    return g != 0 ? __builtin_fabs(s) + __builtin_fabs(t) : __builtin_huge_val();
  };
  const double ia = inclination(ga, ab, ac), ib = inclination(gb, ba, bc), ic = inclination(gc, ca, cb);
  const bool use_b = ib < ia;
  double least = use_b ? ib : ia;
  const bool use_c = ic < least;
  least = use_c ? ic : least;
  const auto sign = [](double g) { return g == 0 ? 0 : __builtin_copysign(1., g); };
  double na = use_c ? ca : use_b ? ba : sign(ga);
  double nb = use_c ? cb : use_b ? sign(gb) : ab;
  double nc = use_c ? sign(gc) : use_b ? bc : ac;
  // Youngs' normal where it is closer to a diagonal: there columns of three cells truncate the interface.
  const double sa = __builtin_fabs(ga), sb = __builtin_fabs(gb), sc = __builtin_fabs(gc);
  const double two = sa > sb ? sa : sb, most = two > sc ? two : sc;
  const bool youngs = ((sa + sb) + sc) - most > least * most;
  na = youngs ? ga : na;
  nb = youngs ? gb : nb;
  nc = youngs ? gc : nc;
  const double sum = (__builtin_fabs(na) + __builtin_fabs(nb)) + __builtin_fabs(nc);
  const double scale = most > 0 ? 1 / sum : 0;
  return {na * scale, nb * scale, nc * scale};
}

}  // namespace eulastic::kernels
