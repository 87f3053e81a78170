// The stress at one point in the form of the momentum equation: that of one phase, and the whole stress.
#pragma once

#include "field/law.hpp"
#include "field/phase.hpp"
#include "flow/local_viscosity.hpp"
#include "grid/box.hpp"

#include <algorithm>
#include <type_traits>

namespace eulastic {

/// Pointers to the components of B of one cell, in the order of the field. In 2-D the last pointers repeat the third.
struct CellTensor {
  CellTensor(const Field &tensor, int i, int j, int k) {
    for (int c = 0; c < 6; ++c) component[c] = &tensor[std::min(c, tensor.count() - 1)](i, j, k);
  }
  const double *component[6];
};

/// sigma_ab of a phase on the low edge of cell (i, j, k) normal to the directions a and b. Reads one ghost of phi and
/// B.
inline double edge_stress(const Box &box, const Phase &phase, int a, int b, int i, int j, int k) {
  const ConstView phi = phase.fraction[0];
  const std::ptrdiff_t stride[3] = {phi.stride(0), phi.stride(1), phi.stride(2)};
  const CellTensor B(phase.tensor.field, i, j, k);
  const double *fraction = &phi(i, j, k);
  const Real3 &h = box.spacing();
  const int c = 3 - a - b;
  const kernels::Directions d{stride[a], stride[b], stride[c], 1 / h[a], 1 / h[b], 1 / h[c]};
  const auto stress = [&](auto dimension) {
    constexpr int dim = decltype(dimension)::value;
    const double part = with_viscosity(
        phase.tensor.rule, [&](const auto &viscosity) { return viscosity.template part<dim>(fraction, d); });
    return part * with_law(phase.material, [&](const auto &law) {
             return law.shear_stress(fraction, kernels::tensor_at<dim>(B.component, stride, a, b), 0);
           });
  };
  return box.dimension() == 2 ? stress(std::integral_constant<int, 2>{}) : stress(std::integral_constant<int, 3>{});
}

/// sigma_aa of a phase at the centre of cell (i, j, k), without its isotropic part. Reads B on the edges of the cell
/// too.
inline double centre_stress(int dimension, const Phase &phase, int a, int i, int j, int k) {
  const ConstView phi = phase.fraction[0];
  const std::ptrdiff_t stride[3] = {phi.stride(0), phi.stride(1), phi.stride(2)};
  const CellTensor B(phase.tensor.field, i, j, k);
  const double fraction = phi(i, j, k);
  return with_law(phase.material, [&](const auto &law) {
    const int b = (a + 1) % dimension;
    return dimension == 2 ? law.normal_stress(fraction, kernels::tensor_at<2>(B.component, stride, a, b), 0)
                          : law.normal_stress(fraction, kernels::tensor_at<3>(B.component, stride, a, b), 0);
  });
}

/// Viscous plus elastic stress without the pressure. Bodies in boxes of their own are not included.
struct TotalStress {
  EdgeViscosity viscosity;
  const Field &velocity;
  const std::vector<Phase> &phases;

  static bool bears_stress(const Phase &phase, const Int3 &cell) {
    return phase.material.elastic() && !phase.boxed && phase.rows.holds(cell[0], cell[1], cell[2]);
  }
  /// sigma_aa at the centre of a cell.
  double normal(int a, const Int3 &cell) const {
    const ConstView u = velocity[a];
    const double *v = &u(cell[0], cell[1], cell[2]);
    double sum = 2 * viscosity.at_centre(cell) * (v[u.stride(a)] - v[0]) / viscosity.box.spacing()[a];
    for (const Phase &phase : phases)
      if (bears_stress(phase, cell))
        sum += centre_stress(viscosity.box.dimension(), phase, a, cell[0], cell[1], cell[2]);
    return sum;
  }
  /// sigma_ab on the low edge of a cell.
  double shear(int a, int b, const Int3 &cell) const {
    const ConstView u = velocity[a], w = velocity[b];
    const double *ua = &u(cell[0], cell[1], cell[2]), *ub = &w(cell[0], cell[1], cell[2]);
    const Real3 &h = viscosity.box.spacing();
    double sum = viscosity.at(a, b, cell) * ((ua[0] - ua[-u.stride(b)]) / h[b] + (ub[0] - ub[-w.stride(a)]) / h[a]);
    for (const Phase &phase : phases)
      if (bears_stress(phase, cell)) sum += edge_stress(viscosity.box, phase, a, b, cell[0], cell[1], cell[2]);
    return sum;
  }
};

}  // namespace eulastic
