// The viscous force with variable viscosity, from compact differences of mu (2 D - 2/3 div v I), in 2-D mu (2 D - div v
// I); docs/method.md, (29).
#pragma once

#include "kernels/points.hpp"

namespace eulastic::kernels {

/// The deviatoric stress per mass around the faces of velocity component a; b and c are the other directions.
/// Viscosities at centres and on edges have the positions of the components of a tensor.
template <int Dim>
struct DeviatoricStress {
  const double *va, *vb, *vc;
  const double *centre, *edge_ab, *edge_ac;
  std::ptrdiff_t a, b, c;
  double ia, ib, ic;  ///< inverse spacings

  /// Returns tau_aa at the centre at offset i, from differences that vanish for a pure dilation.
  EULASTIC_BODY double normal(std::ptrdiff_t i) const noexcept {
    const double A = ia * (va[i + a] - va[i]), B = ib * (vb[i + b] - vb[i]);
    if constexpr (Dim == 2) return centre[i] * (A - B);
    const double C = ic * (vc[i + c] - vc[i]);
    return (2. / 3) * centre[i] * ((A - B) + (A - C));
  }
  /// Returns tau_ab on the low edge ab of the cell at offset i.
  EULASTIC_BODY double shear_ab(std::ptrdiff_t i) const noexcept {
    return edge_ab[i] * fma(ib, va[i] - va[i - b], ia * (vb[i] - vb[i - a]));
  }
  /// Returns tau_ac on the low edge ac of the cell at offset i.
  EULASTIC_BODY double shear_ac(std::ptrdiff_t i) const noexcept {
    return edge_ac[i] * fma(ic, va[i] - va[i - c], ia * (vc[i] - vc[i - a]));
  }
  /// Returns (div tau)_a on the face at offset i.
  EULASTIC_BODY double force(std::ptrdiff_t i) const noexcept {
    double sum = ia * (normal(i) - normal(i - a));
    sum = fma(ib, shear_ab(i + b) - shear_ab(i), sum);
    if constexpr (Dim == 3) sum = fma(ic, shear_ac(i + c) - shear_ac(i), sum);
    return sum;
  }
  /// Returns the force on a face of an open boundary (side = -1: low, 1: high) with even ghosts: the Laplacian, because
  /// div v = 0 on both sides of the boundary, which even ghosts do not satisfy (docs/method.md, section 20).
  EULASTIC_BODY double force_on_open_boundary(std::ptrdiff_t i, int side) const noexcept {
    if constexpr (Dim == 2) return force(i);
    const std::ptrdiff_t inside = side > 0 ? i - a : i;
    return fma(side * (2. / 3) * ia * ia * centre[inside], va[inside + a] - va[inside], force(i));
  }
};

inline constexpr double viscous_force_flops_2d = 29, viscous_force_flops_3d = 54;

}  // namespace eulastic::kernels
