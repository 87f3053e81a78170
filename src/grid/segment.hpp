// A run of cells in x, and views of one field: the only knowledge of the grid that kernels have. Free of PETSc.
#pragma once

#include <cstddef>

namespace eulastic {

/// Cells i_begin <= i < i_end of row (j, k) in local indices; 0 is the first owned cell.
struct Segment {
  int i_begin, i_end, j, k;
  int size() const noexcept { return i_end - i_begin; }
};

/// A non-owning view of consecutive elements.
template <class T>
struct Slice {
  const T *first = nullptr, *last = nullptr;
  const T *begin() const noexcept { return first; }
  const T *end() const noexcept { return last; }
  std::size_t size() const noexcept { return last - first; }
  bool empty() const noexcept { return first == last; }
  const T &operator[](std::size_t n) const noexcept { return first[n]; }
};

/// A non-owning view of one ghosted field. `origin` points to local cell (0,0,0); the stride in x is 1.
template <class T>
struct BasicView {
  T *origin = nullptr;
  std::ptrdiff_t sy = 0, sz = 0;

  T *row(int j, int k) const noexcept { return origin + j * sy + k * sz; }
  T &operator()(int i, int j, int k) const noexcept { return row(j, k)[i]; }
  std::ptrdiff_t stride(int direction) const noexcept { return direction == 0 ? 1 : direction == 1 ? sy : sz; }
  operator BasicView<const T>() const noexcept { return {origin, sy, sz}; }
};

/// 1/h^2 of the three directions. Kernels take it by value: values behind a pointer might alias the output and would be
/// reloaded for every cell.
struct InverseSquares {
  double x, y, z;
};

using View = BasicView<double>;
using ConstView = BasicView<const double>;

}  // namespace eulastic
