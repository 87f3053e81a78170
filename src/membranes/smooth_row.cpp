#include "membranes/smooth_row.hpp"

#include "kernels/stencils.hpp"

#include <algorithm>

namespace eulastic {
namespace {

constexpr int half = smooth_reach;
constexpr double weights[half + 1] = {6. / 16, 4. / 16, 1. / 16};

}  // namespace

// Adds opposite points first, so that a mirrored field gives mirrored bits.
EULASTIC_CLONES void smooth_row(int dim, ConstView q, int j, int k, int begin, int end, double *across, double *out) {
  const int first = begin - half, last = end + half;
  std::fill(across + first, across + last, 0.0);
  for (int m = 0; m <= (dim == 3 ? half : 0); ++m)
    for (int n = 0; n <= half; ++n) {
      const double w = (dim == 3 ? weights[m] : 1) * weights[n];
      const double *low = q.row(j - n, k - m), *high = q.row(j + n, k - m);
      const double *low2 = q.row(j - n, k + m), *high2 = q.row(j + n, k + m);
      const double share = (m == 0 ? 0.5 : 1) * (n == 0 ? 0.5 : 1) * w;
#pragma omp simd
      for (int i = first; i < last; ++i)
        across[i] = kernels::fma(share, (low[i] + high2[i]) + (high[i] + low2[i]), across[i]);
    }
#pragma omp simd
  for (int i = begin; i < end; ++i) {
    double sum = weights[0] * across[i];
    for (int n = 1; n <= half; ++n) sum = kernels::fma(weights[n], across[i - n] + across[i + n], sum);
    out[i] = sum;
  }
}

// The force on a face reads the row below and what is smoothed around both.
bool is_near_occupied_row(const Box &box, const OccupiedRows &rows, int j, int k) {
  const int reach = half + 1, reach_z = box.dimension() == 3 ? reach : 0;
  for (int m = -reach_z; m <= reach_z; ++m)
    for (int o = -reach; o <= reach; ++o)
      if (!rows.idle(j + o, k + m)) return true;
  return false;
}

void clear_near_rows(const Box &box, const OccupiedRows &rows, int ghosts, View field) {
  const Int3 &n = box.cells();
  const int dim = box.dimension(), width = rows.inside() ? 0 : ghosts, layers_z = dim == 3 ? ghosts : 0;
  const auto near = [&](int j, int k) {
    if (width > 0 && (j < width || j >= n[1] - width || (dim == 3 && (k < width || k >= n[2] - width)))) return true;
    return is_near_occupied_row(box, rows, j, k);
  };
  for (int k = -layers_z; k < n[2] + layers_z; ++k)
    for (int j = -ghosts; j < n[1] + ghosts; ++j) {
      double *row = field.row(j, k);
      if (near(j, k)) {
        std::fill(row - ghosts, row + n[0] + ghosts, 0.0);
      } else if (width > 0 && !box.spans(0)) {
        std::fill(row, row + std::min(width, n[0]), 0.0);
        std::fill(row + std::max(n[0] - width, 0), row + n[0], 0.0);
      }
    }
}

}  // namespace eulastic
