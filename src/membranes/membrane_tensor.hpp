// Access to the tensor B_s of one cell.
#pragma once

#include "field/field.hpp"
#include "kernels/membrane.hpp"

namespace eulastic {

template <int Dim>
EULASTIC_INLINE kernels::Tensor<Dim> tensor_at(const Field &B, std::ptrdiff_t at) {
  kernels::Tensor<Dim> t;
  for (int a = 0; a < Dim; ++a)
    for (int b = 0; b < Dim; ++b) t[a][b] = B[kernels::position<Dim>(a, b)].origin[at];
  return t;
}

template <int Dim>
EULASTIC_INLINE void set_tensor(Field &B, std::ptrdiff_t at, const kernels::Tensor<Dim> &t) {
  for (int a = 0; a < Dim; ++a)
    for (int b = a; b < Dim; ++b) B[kernels::position<Dim>(a, b)].origin[at] = t[a][b];
}

template <int Dim>
EULASTIC_INLINE kernels::Vector<Dim> normal_of(const Real3 &n) {
  kernels::Vector<Dim> v;
  for (int d = 0; d < Dim; ++d) v[d] = n[d];
  return v;
}

}  // namespace eulastic
