// A symmetric tensor as it is stored, with the diagonal at centres and the other components on edges, and its
// components relative to two directions.
#pragma once

#include "kernels/stencils.hpp"

namespace eulastic::kernels {

/// Returns the index of component (x, y) in the order of tensor_components().
template <int Dim>
constexpr int position(int x, int y) {
  return x == y ? x : Dim == 2 ? 2 : 6 - x - y;
}

/// The components of B relative to the directions a, b, c, as pointers, and the strides of these directions. In 2-D c
/// is unused.
template <int Dim>
struct TensorAt {
  const double *aa, *bb, *cc, *ab, *ac, *bc;
  std::ptrdiff_t a, b, c;
};

/// Returns the components of B relative to the directions a and b; `B` points to the components in their order.
template <int Dim>
EULASTIC_INLINE TensorAt<Dim> tensor_at(const double *const *B, const std::ptrdiff_t *stride, int a, int b) noexcept {
  if (Dim == 2) return {B[a], B[b], B[a], B[2], B[2], B[2], stride[a], stride[b], 0};
  const int c = 3 - a - b;
  return {B[a],      B[b],      B[c],     B[position<Dim>(a, b)], B[position<Dim>(a, c)], B[position<Dim>(b, c)],
          stride[a], stride[b], stride[c]};
}

/// Returns tr B - 3 at a centre; in 2-D B_zz = 1.
template <int Dim>
EULASTIC_INLINE double excess_trace(const TensorAt<Dim> &t, std::ptrdiff_t i) noexcept {
  const double sum = (t.aa[i] - 1) + (t.bb[i] - 1);
  return Dim == 3 ? sum + (t.cc[i] - 1) : sum;
}

/// Bounds that follow from tr B: the largest squared stretch, the inverse of the smallest one, and tr B - 3.
struct StretchBounds {
  double stretch, inverse, excess;
};

}  // namespace eulastic::kernels
