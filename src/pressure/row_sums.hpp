// Exact sums of products over rows.
#pragma once

#include "base/exact_sum.hpp"
#include "kernels/poisson.hpp"

namespace eulastic {

/// Adds N sums over a row of n cells, the first of which has the absolute x index `begin`, to `sums`. `product` is
/// called as by lane_sums(), with the cells of this row.
template <int N, class Product>
EULASTIC_INLINE void add_row_sums(int n, std::int64_t begin, Product product, ExactSums &sums) {
  for (int from = 0; from < n;) {
    const std::int64_t first = begin + from;
    const int length = std::min<int>(n - from, ExactSums::block - static_cast<int>(first % ExactSums::block));
    double sum[N];
    kernels::lane_sums<N>(
        length, first, [=](int i, auto add) EULASTIC_BODY { product(from + i, add); }, sum);
    for (int s = 0; s < N; ++s) sums.add(s, sum[s]);
    from += length;
  }
}

}  // namespace eulastic
