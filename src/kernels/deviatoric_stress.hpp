// The viscous force where viscosity varies: compact differences of mu (2 D - 2/3 div v I), in 2-D of mu (2 D - div v
// I).
#pragma once

#include "kernels/points.hpp"

namespace eulastic::kernels {

/// The deviatoric stress per mass around the faces of component a; b, c: the other directions. Viscosities at centres
/// and on edges lie like the tensor's components.
template <int Dim>
struct DeviatoricStress {
  const double *va, *vb, *vc;
  const double *centre, *edge_ab, *edge_ac;
  std::ptrdiff_t a, b, c;
  double ia, ib, ic;  ///< inverse spacings

  /// tau_aa at the centre at offset i: twice the deviator of D, from differences that vanish for a pure dilation.
  EULASTIC_BODY double normal(std::ptrdiff_t i) const noexcept {
    const double A = ia * (va[i + a] - va[i]), B = ib * (vb[i + b] - vb[i]);
    if constexpr (Dim == 2) return centre[i] * (A - B);
    const double C = ic * (vc[i + c] - vc[i]);
    return (2. / 3) * centre[i] * ((A - B) + (A - C));
  }
  /// tau_ab, tau_ac on the low edge of the cell at offset i.
  EULASTIC_BODY double shear_ab(std::ptrdiff_t i) const noexcept {
    return edge_ab[i] * fma(ib, va[i] - va[i - b], ia * (vb[i] - vb[i - a]));
  }
  EULASTIC_BODY double shear_ac(std::ptrdiff_t i) const noexcept {
    return edge_ac[i] * fma(ic, va[i] - va[i - c], ia * (vc[i] - vc[i - a]));
  }
  /// (div tau)_a at the face at offset i.
  EULASTIC_BODY double force(std::ptrdiff_t i) const noexcept {
    double sum = ia * (normal(i) - normal(i - a));
    sum = fma(ib, shear_ab(i + b) - shear_ab(i), sum);
    if constexpr (Dim == 3) sum = fma(ic, shear_ac(i + c) - shear_ac(i), sum);
    return sum;
  }
  /// The same on an open side of the box (-1: low, 1: high) with even ghosts: the Laplacian, as div v = 0 on both sides
  /// of it, which what is even does not have.
  EULASTIC_BODY double force_on_side(std::ptrdiff_t i, int side) const noexcept {
    if constexpr (Dim == 2) return force(i);
    const std::ptrdiff_t inside = side > 0 ? i - a : i;
    return fma(side * (2. / 3) * ia * ia * centre[inside], va[inside + a] - va[inside], force(i));
  }
};

inline constexpr double viscous_force_flops_2d = 29, viscous_force_flops_3d = 54;

}  // namespace eulastic::kernels
