#include "pressure/tridiagonal.hpp"

namespace eulastic {

void TridiagonalLines::remove_mean(int lane) {
  double sum = 0;
  for (int j = 0; j < cells_; ++j) sum += row(j)[lane];
  for (int j = 0; j < cells_; ++j) row(j)[lane] -= sum / cells_;
}

// The last unknown is eliminated separately. With T the matrix of the others and c its coupling to them, y = T^-1 g and
// z = T^-1 c give q_j = y_j + z_j q_last, and the last equation yields q_last. This is Gaussian elimination of a
// diagonally dominant symmetric matrix, hence backward stable, both between boundaries and in the cyclic case. The
// singular lane differs only in q_last = 0.
void TridiagonalLines::solve(const double *shift) {
  const int last = cells_ - 1;
  const auto end = [&](int side) { return periodic_ ? 2 : open_[side] ? 3 : 1; };
  const double low = end(0), high = end(1), link = periodic_ ? 1 : 0;
  const bool free = !open_[0] && !open_[1];
  double *y = row(0), *z = row(cells_), *m = row(2 * cells_);  // m: reciprocal pivots
  for (int l = 0; l < lanes; ++l)
    if (free && shift[l] == 0) remove_mean(l);
#pragma omp simd
  for (int l = 0; l < lanes; ++l) {
    m[l] = 1 / (low + shift[l]);
    y[l] *= m[l];
    z[l] = link * m[l];
  }
  for (int j = 1; j < last; ++j) {
    const double coupling = j == last - 1 ? 1 : 0;
    double *yj = y + lanes * j, *zj = z + lanes * j, *mj = m + lanes * j;
#pragma omp simd
    for (int l = 0; l < lanes; ++l) {
      mj[l] = 1 / (2 + shift[l] - mj[l - lanes]);
      yj[l] = (yj[l] + yj[l - lanes]) * mj[l];
      zj[l] = (coupling + zj[l - lanes]) * mj[l];
    }
  }
  for (int j = last - 2; j >= 0; --j) {
    double *yj = y + lanes * j, *zj = z + lanes * j, *mj = m + lanes * j;
#pragma omp simd
    for (int l = 0; l < lanes; ++l) {
      yj[l] += mj[l] * yj[l + lanes];
      zj[l] += mj[l] * zj[l + lanes];
    }
  }
  double *q = row(last);
  const double *y_high = row(last - 1), *z_high = z + lanes * (last - 1);
  for (int l = 0; l < lanes; ++l)
    q[l] = free && shift[l] == 0 ? 0 : (q[l] + y_high[l] + link * y[l]) / (high + shift[l] - z_high[l] - link * z[l]);
  for (int j = 0; j < last; ++j) {
    double *yj = y + lanes * j, *zj = z + lanes * j;
#pragma omp simd
    for (int l = 0; l < lanes; ++l) yj[l] += zj[l] * q[l];
  }
  for (int l = 0; l < lanes; ++l)
    if (free && shift[l] == 0) remove_mean(l);
}

}  // namespace eulastic
