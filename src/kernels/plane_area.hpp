// Area of the plane that cuts a cell: its projection along d is m_d V'(alpha) times the cell's face (docs/method.md,
// section 17).
#pragma once

#include "kernels/interface_normal.hpp"
#include "kernels/plane.hpp"

namespace eulastic::kernels {

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
