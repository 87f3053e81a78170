// The elastic shear stress of a phase on one edge, as the momentum equation sees it.
#pragma once

#include "field/law.hpp"
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
  const CellTensor B(phase.tensor, i, j, k);
  const double *fraction = &phi(i, j, k);
  return with_law(phase.material, [&](const auto &law) {
    return dimension == 2 ? law.shear_stress(fraction, kernels::tensor_at<2>(B.component, stride, a, b), 0)
                          : law.shear_stress(fraction, kernels::tensor_at<3>(B.component, stride, a, b), 0);
  });
}

}  // namespace eulastic
