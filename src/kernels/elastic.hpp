// Divergence of the neo-Hookean stress G phi dev(B) of (3) at the faces of one velocity component.
#pragma once

#include "kernels/stencils.hpp"

namespace eulastic::kernels {

inline constexpr double elastic_flops_2d = 32, elastic_flops_3d = 57;  ///< per face

/// G phi (B_aa - tr B / 3) at a centre; b, c are the other two diagonal components (c = null: B_zz = 1 in 2-D).
template <int Dim>
EULASTIC_INLINE double normal_stress(const double *phi, const double *a, const double *b, const double *c,
                                     double modulus) noexcept {
  const double cc = Dim == 3 ? *c : 1.0;
  return modulus * *phi * (1. / 3) * ((*a - *b) + (*a - cc));
}

/// G avg4(phi) B_ab on an edge; da, db are the strides of the two directions.
EULASTIC_INLINE double shear_stress(const double *phi, const double *ab, std::ptrdiff_t da, std::ptrdiff_t db,
                                    double modulus) noexcept {
  return modulus * average4(phi, -da, -db) * *ab;
}

/// Where the tensor components that face a sees live: diagonal a, b, c and edges ab, ac.
struct TensorViews {
  ConstView aa, bb, cc, ab, ac;
};

/// add(offset, modulus div(phi dev B)_a) for all points. Strides and 1/h of the directions a, b, c; in 2-D c is unused.
template <int Dim, class Points, class Add>
EULASTIC_INLINE void elastic_force(const Points &points, ConstView phi, const TensorViews &tensor,
                                   const std::ptrdiff_t *stride, const double *inverse_spacing, double modulus,
                                   Add add) noexcept {
  const std::ptrdiff_t da = stride[0], db = stride[1], dc = stride[2];
  const double ia = inverse_spacing[0], ib = inverse_spacing[1], ic = inverse_spacing[2];
  const double *f = phi.origin, *aa = tensor.aa.origin, *bb = tensor.bb.origin, *ab = tensor.ab.origin;
  const double *cc = Dim == 3 ? tensor.cc.origin : aa, *ac = Dim == 3 ? tensor.ac.origin : aa;
  for_points(points, phi, [=](std::ptrdiff_t i, int) EULASTIC_BODY {
    double sum = ia * (normal_stress<Dim>(f + i, aa + i, bb + i, cc + i, modulus) -
                       normal_stress<Dim>(f + i - da, aa + i - da, bb + i - da, cc + i - da, modulus));
    sum = fma(ib, shear_stress(f + i + db, ab + i + db, da, db, modulus) - shear_stress(f + i, ab + i, da, db, modulus),
              sum);
    if constexpr (Dim == 3)
      sum =
          fma(ic, shear_stress(f + i + dc, ac + i + dc, da, dc, modulus) - shear_stress(f + i, ac + i, da, dc, modulus),
              sum);
    add(i, sum);
  });
}

}  // namespace eulastic::kernels
