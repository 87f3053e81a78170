// The Laplacian on lines of unequal cells, transfers between two grids row by row, and sums of products.
#pragma once

#include "grid/segment.hpp"
#include "kernels/isa.hpp"

#include <algorithm>
#include <cstdint>

namespace eulastic::kernels {

/// Couplings of the cells of one row to their neighbours, 1/(width x distance of centres); 0 at a wall, so that no
/// ghost is needed there. Along x there is one number per cell. The operator is lap - shift.
struct LineCoefficients {
  const double *x_low, *x_high;
  double y_low, y_high, z_low, z_high, shift;
};

inline constexpr double line_laplacian_flops_per_direction = 6;

/// Returns the sum over directions of low (q[-1] - q[0]) + high (q[+1] - q[0]), less shift q[0], at cell i of the row
/// q.
template <int Dim>
EULASTIC_INLINE double line_laplacian(const double *q, int i, std::ptrdiff_t sy, std::ptrdiff_t sz,
                                      const LineCoefficients &c) noexcept {
  const double centre = q[i];
  double sum = c.x_low[i] * (q[i - 1] - centre);
  sum = fma(c.x_high[i], q[i + 1] - centre, sum);
  sum = fma(c.y_low, q[i - sy] - centre, sum);
  sum = fma(c.y_high, q[i + sy] - centre, sum);
  if constexpr (Dim == 3) {
    sum = fma(c.z_low, q[i - sz] - centre, sum);
    sum = fma(c.z_high, q[i + sz] - centre, sum);
  }
  return fma(-c.shift, centre, sum);
}

/// Adds sum += weight (r - factor lap r) for `Rows` rows from s on: the residual of the right-hand side r after one
/// relaxation from zero.
template <int Dim, int Rows>
EULASTIC_INLINE void add_relaxed_residual(const Segment &s, ConstView r, const LineCoefficients *coefficients,
                                          const double *weight, double factor, double *sum) noexcept {
  const double *f = r.row(s.j, s.k);
  const std::ptrdiff_t sy = r.sy, sz = r.sz;
  LineCoefficients c[Rows];
  double w[Rows];
  for (int b = 0; b < Rows; ++b) {
    c[b] = coefficients[b];
    w[b] = weight[b];
  }
#pragma omp simd
  for (int i = s.i_begin; i < s.i_end; ++i) {
    double total = sum[i];
#pragma GCC unroll 2
    for (int b = 0; b < Rows; ++b)
      total = fma(w[b], fma(-factor, line_laplacian<Dim>(f + b * sy, i, sy, sz, c[b]), f[b * sy + i]), total);
    sum[i] = total;
  }
}

/// Computes out = q + factor (r - lap q), one relaxation.
template <int Dim>
EULASTIC_INLINE void relax(const Segment &s, ConstView q, ConstView r, LineCoefficients c, double factor,
                           View out) noexcept {
  const double *old = q.row(s.j, s.k), *f = r.row(s.j, s.k);
  double *next = out.row(s.j, s.k);
  const std::ptrdiff_t sy = q.sy, sz = q.sz;
#pragma omp simd
  for (int i = s.i_begin; i < s.i_end; ++i)
    next[i] = fma(factor, f[i] - line_laplacian<Dim>(old, i, sy, sz, c), old[i]);
}

/// Restricts pairs of fine values to coarse values: coarse[i] = low[i] fine[2i] + high[i] fine[2i + 1].
EULASTIC_INLINE void restrict_pairs(int n, const double *fine, const double *low, const double *high,
                                    double *coarse) noexcept {
#pragma omp simd
  for (int i = 0; i < n; ++i) coarse[i] = fma(low[i], fine[2 * i], high[i] * fine[2 * i + 1]);
}

/// Rows of coarse cells around a row of fine cells: the row that contains it, its neighbour in y, and the same two rows
/// in the neighbouring plane in z. y and z are the weights of the neighbours.
struct CoarseRows {
  const double *row[4];
  double y, z;

  /// Returns the coarse values interpolated along y and z.
  EULASTIC_INLINE double at(int i) const noexcept {
    const double near = fma(y, row[1][i] - row[0][i], row[0][i]), far = fma(y, row[3][i] - row[2][i], row[2][i]);
    return fma(z, far - near, near);
  }
};

/// Computes out = factor r + the interpolated coarse values, for directions x that are not coarsened.
EULASTIC_INLINE void add_interpolated(int begin, int end, CoarseRows coarse, double factor, const double *r,
                                      double *out) noexcept {
#pragma omp simd
  for (int i = begin; i < end; ++i) out[i] = fma(factor, r[i], coarse.at(i));
}

/// The same where x is coarsened by two; low and high are the weights of the neighbours in x.
EULASTIC_INLINE void add_interpolated_pairs(int begin, int end, CoarseRows coarse, const double *low,
                                            const double *high, double factor, const double *r, double *out) noexcept {
#pragma omp simd
  for (int i = begin; i < end; ++i) {
    const double own = coarse.at(i);
    out[2 * i] = fma(factor, r[2 * i], fma(low[i], coarse.at(i - 1) - own, own));
    out[2 * i + 1] = fma(factor, r[2 * i + 1], fma(high[i], coarse.at(i + 1) - own, own));
  }
}

/// Computes N sums of products over [0, n), at most one block of the exact sums, each in eight fixed lanes (absolute
/// index mod 8) and a fixed tree; the first point has the absolute index `first`. product(i, add) calls add(s, a, b)
/// for every sum s. All sums are computed in one loop, because a single one would wait for its own last addition.
template <int N, class Product>
EULASTIC_INLINE void lane_sums(int n, std::int64_t first, Product product, double *sum) noexcept {
  double lane[N][8];
  const auto at = [&](int i, int l) EULASTIC_BODY {
    product(i, [&, l](int s, double a, double b) EULASTIC_BODY { lane[s][l] = fma(a, b, lane[s][l]); });
  };
  int i = 0;
  if (n >= 8 && (first & 7) == 0) {
#pragma omp simd
    for (int l = 0; l < 8; ++l) product(l, [&, l](int s, double a, double b) EULASTIC_BODY { lane[s][l] = a * b; });
    i = 8;
  } else {
    for (int s = 0; s < N; ++s) std::fill_n(lane[s], 8, 0.0);
    for (; i < n && ((first + i) & 7); ++i) at(i, static_cast<int>((first + i) & 7));
  }
  for (; i + 8 <= n; i += 8) {
    asm volatile("");  // GCC 12 would combine two groups at half the vector width and spill the sums to memory
#pragma omp simd
    for (int l = 0; l < 8; ++l) at(i + l, l);
  }
  for (int l = 0; i < n; ++i, ++l) at(i, l);
  for (int s = 0; s < N; ++s) {  // a fixed tree: ((0 4) (2 6)) ((1 5) (3 7))
    double half[4];
#pragma omp simd
    for (int l = 0; l < 4; ++l) half[l] = lane[s][l] + lane[s][l + 4];
    sum[s] = (half[0] + half[2]) + (half[1] + half[3]);
  }
}

}  // namespace eulastic::kernels
