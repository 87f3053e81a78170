// The elastic stress of a phase at one place, as the momentum equation sees it.
#pragma once

#include "field/law.hpp"
#include "field/local_viscosity.hpp"
#include "field/phase.hpp"

#include <algorithm>

namespace eulastic {

/// Pointers to the components of B of one cell, in their order; 2-D has three.
struct CellTensor {
  CellTensor(const FieldBlock &tensor, int i, int j, int k) {
    for (int c = 0; c < 6; ++c) component[c] = &tensor[std::min(c, tensor.count() - 1)](i, j, k);
  }
  const double *component[6];
};

/// sigma_ab on the low edge of cell (i, j, k) normal to the directions a and b. One ghost layer of phi and B.
inline double edge_stress(int dimension, const Phase &phase, int a, int b, int i, int j, int k) {
  const ConstView phi = phase.fraction[0];
  const std::ptrdiff_t stride[3] = {phi.stride(0), phi.stride(1), phi.stride(2)};
  const CellTensor B(phase.tensor.field, i, j, k);
  const double *fraction = &phi(i, j, k);
  return with_law(phase.material, [&](const auto &law) {
    return dimension == 2 ? law.shear_stress(fraction, kernels::tensor_at<2>(B.component, stride, a, b), 0)
                          : law.shear_stress(fraction, kernels::tensor_at<3>(B.component, stride, a, b), 0);
  });
}

/// sigma_aa at the centre of cell (i, j, k), without its mean over the directions. B of its edges too.
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

/// Viscous and elastic stress together, without the pressure.
struct WholeStress {
  EdgeViscosity viscosity;
  const FieldBlock &velocity;
  const std::vector<Phase> &phases;

  double normal(int a, const Int3 &cell) const {
    const ConstView u = velocity[a];
    const double *v = &u(cell[0], cell[1], cell[2]);
    double sum = 2 * viscosity.at_centre(cell) * (v[u.stride(a)] - v[0]) / viscosity.grid.spacing()[a];
    for (const Phase &phase : phases)
      if (phase.material.elastic() && phase.rows.holds(cell[0], cell[1], cell[2]))
        sum += centre_stress(viscosity.grid.dimension(), phase, a, cell[0], cell[1], cell[2]);
    return sum;
  }
  /// On the low edge of a cell.
  double shear(int a, int b, const Int3 &cell) const {
    const ConstView u = velocity[a], w = velocity[b];
    const double *ua = &u(cell[0], cell[1], cell[2]), *ub = &w(cell[0], cell[1], cell[2]);
    const Real3 &h = viscosity.grid.spacing();
    double sum = viscosity.at(a, b, cell) * ((ua[0] - ua[-u.stride(b)]) / h[b] + (ub[0] - ub[-w.stride(a)]) / h[a]);
    for (const Phase &phase : phases)
      if (phase.material.elastic() && phase.rows.holds(cell[0], cell[1], cell[2]))
        sum += edge_stress(viscosity.grid.dimension(), phase, a, b, cell[0], cell[1], cell[2]);
    return sum;
  }
};

}  // namespace eulastic
