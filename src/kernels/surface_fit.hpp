// Fits values at scattered points of a surface by a quadratic over its tangent plane, with weighted least squares;
// docs/method.md, section 18.
#pragma once

#include "kernels/membrane.hpp"

namespace eulastic::kernels {

/// Up to `most` points around a point of a surface, in groups of eight; the last group is padded with points of weight
/// 0. u, v: coordinates in the plane; 2-D does not use v.
template <int Values>
struct SurfacePoints {
  static constexpr int most = 128, lanes = 8;
  alignas(64) double u[most], v[most], weight[most], value[Values][most];
  int count = 0;
  void pad_to_lanes() noexcept {
    for (; count % lanes != 0; ++count) {
      u[count] = v[count] = weight[count] = 0;
      for (auto &one : value) one[count] = 0;
    }
  }
};

/// Coefficients of 1, u, (v,) u^2, (u v, v^2) for each value.
template <int Dim, int Values>
struct SurfaceFit {
  static constexpr int terms = Dim == 3 ? 6 : 3, pairs = terms * (terms + 1) / 2;
  double coefficient[terms][Values];
  double residual;  ///< weighted mean square of the deviations of the first Dim values
};

EULASTIC_INLINE double sum_of_lanes(const double *v) noexcept {
  return ((v[0] + v[1]) + (v[2] + v[3])) + ((v[4] + v[5]) + (v[6] + v[7]));
}

/// Replaces the lower half of a symmetric matrix by its Cholesky factor. Returns false if the matrix is nearly
/// singular.
template <int N>
EULASTIC_INLINE bool factorise(double (&L)[N][N]) noexcept {
  constexpr double least = 1e-4;  // the smallest pivot relative to its diagonal element
  for (int c = 0; c < N; ++c) {
    const double diagonal = L[c][c];
    for (int k = 0; k < c; ++k) L[c][c] -= L[c][k] * L[c][k];
    if (!(L[c][c] > least * diagonal)) return false;
    L[c][c] = __builtin_sqrt(L[c][c]);
    for (int r = c + 1; r < N; ++r) {
      for (int k = 0; k < c; ++k) L[r][c] -= L[r][k] * L[c][k];
      L[r][c] /= L[c][c];
    }
  }
  return true;
}

/// Replaces column q of x by the solution of L L^T y = x.
template <int N, int Values>
EULASTIC_INLINE void solve_column(const double (&L)[N][N], int q, double (&x)[N][Values]) noexcept {
  for (int r = 0; r < N; ++r) {
    for (int k = 0; k < r; ++k) x[r][q] -= L[r][k] * x[k][q];
    x[r][q] /= L[r][r];
  }
  for (int r = N - 1; r >= 0; --r) {
    for (int k = r + 1; k < N; ++k) x[r][q] -= L[k][r] * x[k][q];
    x[r][q] /= L[r][r];
  }
}

/// Fits points after pad_to_lanes(). Returns false, with unusable coefficients, where the points do not determine the
/// fit.
template <int Dim, int Values>
EULASTIC_INLINE bool fit_surface(const SurfacePoints<Values> &p, SurfaceFit<Dim, Values> *fit) noexcept {
  using Fit = SurfaceFit<Dim, Values>;
  constexpr int terms = Fit::terms, lanes = SurfacePoints<Values>::lanes;
  alignas(64) double moments[Fit::pairs][lanes] = {}, sums[terms][Values][lanes] = {}, squares[lanes] = {};
  for (int first = 0; first < p.count; first += lanes) {
    alignas(64) double f[terms][lanes], wf[terms][lanes];
#pragma omp simd
    for (int l = 0; l < lanes; ++l) {
      const double u = p.u[first + l], v = p.v[first + l];
      f[0][l] = 1;
      f[1][l] = u;
      f[2][l] = Dim == 3 ? v : u * u;
      if constexpr (Dim == 3) {
        f[3][l] = u * u;
        f[4][l] = u * v;
        f[5][l] = v * v;
      }
    }
    for (int i = 0, pair = 0; i < terms; ++i) {
#pragma omp simd
      for (int l = 0; l < lanes; ++l) wf[i][l] = p.weight[first + l] * f[i][l];
      for (int j = 0; j <= i; ++j, ++pair)
#pragma omp simd
        for (int l = 0; l < lanes; ++l) moments[pair][l] = fma(wf[i][l], f[j][l], moments[pair][l]);
      for (int q = 0; q < Values; ++q)
#pragma omp simd
        for (int l = 0; l < lanes; ++l) sums[i][q][l] = fma(wf[i][l], p.value[q][first + l], sums[i][q][l]);
    }
    for (int q = 0; q < Dim; ++q)
#pragma omp simd
      for (int l = 0; l < lanes; ++l) {
        const double value = p.value[q][first + l];
        squares[l] = fma(p.weight[first + l] * value, value, squares[l]);
      }
  }
  double L[terms][terms], right[terms][Values];
  for (int i = 0, pair = 0; i < terms; ++i) {
    for (int j = 0; j <= i; ++j, ++pair) L[i][j] = sum_of_lanes(moments[pair]);
    for (int q = 0; q < Values; ++q) right[i][q] = fit->coefficient[i][q] = sum_of_lanes(sums[i][q]);
  }
  const double weight = L[0][0];
  if (!factorise(L)) return false;
  double remainder = sum_of_lanes(squares);
  for (int q = 0; q < Values; ++q) {
    solve_column(L, q, fit->coefficient);
    for (int r = 0; q < Dim && r < terms; ++r) remainder -= right[r][q] * fit->coefficient[r][q];
  }
  fit->residual = remainder > 0 ? remainder / weight : 0;
  return true;
}

/// Returns the unit vectors along the surface normal to n; one in 2-D.
template <int Dim>
EULASTIC_INLINE std::array<Vector<Dim>, Dim - 1> tangents(const Vector<Dim> &n) noexcept {
  if constexpr (Dim == 2) {
    return {{{-n[1], n[0]}}};
  } else {
    int least = 0;
    for (int d = 1; d < 3; ++d)
      if (__builtin_fabs(n[d]) < __builtin_fabs(n[least])) least = d;
    Vector<3> a{}, b{};
    const int p = (least + 1) % 3, q = (least + 2) % 3;
    const double size = __builtin_sqrt(n[p] * n[p] + n[q] * n[q]);
    a[p] = -n[q] / size;
    a[q] = n[p] / size;
    for (int d = 0; d < 3; ++d) b[d] = n[(d + 1) % 3] * a[(d + 2) % 3] - n[(d + 2) % 3] * a[(d + 1) % 3];
    return {a, b};
  }
}

/// Returns the tensor in the plane of t whose components along t are the inverse of G.
template <int Dim>
EULASTIC_INLINE Tensor<Dim> inverse_in_plane(const std::array<Vector<Dim>, Dim - 1> &t,
                                             const double (&G)[Dim - 1][Dim - 1]) noexcept {
  Tensor<Dim> out{};
  if constexpr (Dim == 2) {
    for (int x = 0; x < 2; ++x)
      for (int y = 0; y < 2; ++y) out[x][y] = t[0][x] * t[0][y] / G[0][0];
  } else {
    const double det = G[0][0] * G[1][1] - G[0][1] * G[1][0];
    for (int x = 0; x < 3; ++x)
      for (int y = 0; y < 3; ++y)
        out[x][y] = (G[1][1] * (t[0][x] * t[0][y]) + G[0][0] * (t[1][x] * t[1][y]) -
                     G[0][1] * (t[0][x] * t[1][y] + t[1][x] * t[0][y])) /
                    det;
  }
  return out;
}

/// Returns the weight of a point r cells away in the interpolation from the four points next to a position along a
/// direction, with a continuous slope and exact for quadratic functions (Keys, IEEE Trans. Acoust. Speech Signal
/// Process. 29, 1981, a = -1/2).
EULASTIC_INLINE double keys4(double r) noexcept {
  const double a = __builtin_fabs(r);
  if (a < 1) return fma(fma(1.5, a, -2.5), a * a, 1);
  return a < 2 ? fma(fma(fma(-0.5, a, 2.5), a, -4.0), a, 2.0) : 0;
}

}  // namespace eulastic::kernels
