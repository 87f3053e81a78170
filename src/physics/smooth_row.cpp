#include "physics/smooth_row.hpp"

#include "kernels/stencils.hpp"

#include <algorithm>

namespace eulastic {
namespace {

constexpr int half = smooth_reach;
constexpr double weights[half + 1] = {6. / 16, 4. / 16, 1. / 16};

}  // namespace

// Pairs first: mirrored bits.
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

}  // namespace eulastic
