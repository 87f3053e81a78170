// A run of cells in x, and plain views of one field: all that a kernel ever sees of the grid. PETSc-free.
#pragma once

#include <cstddef>

namespace eulastic {

/// Cells i_begin <= i < i_end of the row (j, k); local indices, 0 is the first owned cell.
struct Segment {
  int i_begin, i_end, j, k;
  int size() const noexcept { return i_end - i_begin; }
};

/// One ghosted field. `origin` is the value of local cell (0,0,0); the stride in x is 1.
template <class T>
struct BasicView {
  T *origin = nullptr;
  std::ptrdiff_t sy = 0, sz = 0;

  T *row(int j, int k) const noexcept { return origin + j * sy + k * sz; }
  T &operator()(int i, int j, int k) const noexcept { return row(j, k)[i]; }
  std::ptrdiff_t stride(int direction) const noexcept { return direction == 0 ? 1 : direction == 1 ? sy : sz; }
  operator BasicView<const T>() const noexcept { return {origin, sy, sz}; }
};

/// 1/h^2 of the three directions. Kernels take a copy: what a pointer leads to could be what they write, and would be
/// read again for every cell.
struct InverseSquares {
  double x, y, z;
};

using View = BasicView<double>;
using ConstView = BasicView<const double>;

}  // namespace eulastic
