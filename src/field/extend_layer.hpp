// Extrapolation layer by layer: the points of a layer take the mean of their face neighbours in lower layers.
#pragma once

#include "base/petsc.hpp"
#include "grid/threads.hpp"
#include "kernels/stencils.hpp"

#include <algorithm>
#include <cstdint>
#include <vector>

namespace eulastic {

/// A point of a layer, and the neighbours that its mean contains.
struct LayerPoint {
  PetscInt offset;           ///< offset from the first double of the field
  unsigned char neighbours;  ///< see neighbour_bits()
  unsigned char lines;       ///< neighbours with two more points behind them, from which the extrapolation is linear
  LayerPoint(std::ptrdiff_t at, unsigned from, unsigned along) noexcept
      : offset(static_cast<PetscInt>(at)),
        neighbours(static_cast<unsigned char>(from)),
        lines(static_cast<unsigned char>(along)) {}
};

/// Returns the bits of the neighbours for which counts(step) is true: low x, high x, low y, high y, low z, high z.
template <class Counts>
unsigned neighbour_bits(int dimension, const std::ptrdiff_t *stride, const Counts &counts) {
  unsigned bits = 0;
  for (int d = 0; d < dimension; ++d) {
    if (counts(-stride[d])) bits |= 1u << (2 * d);
    if (counts(stride[d])) bits |= 2u << (2 * d);
  }
  return bits;
}

/// Extrapolates from the neighbour b[step] to b[0]: constant, or linear with the minmod slope.
inline double extrapolated(const double *b, std::ptrdiff_t step, bool linear) {
  if (!linear) return b[step];
  return b[step] + kernels::minmod(b[step] - b[2 * step], b[2 * step] - b[3 * step]);
}

/// Sets every point of piece `piece` of a layer to the mean over its neighbours, for `Fields` components at the same
/// points, whose values are `size` doubles apart. Returns the flops: one per neighbour, and seven more for a linear
/// extrapolation.
template <int Fields>
double extend_layer(const std::vector<LayerPoint> &points, Piece piece, int dimension, const std::ptrdiff_t *stride,
                    std::ptrdiff_t size, double *values) {
  std::int64_t flops = 0;
  const std::ptrdiff_t slice = stride[dimension - 1];
  for (std::size_t n = piece.begin; n < piece.end; ++n) {
    const LayerPoint &point = points[n];
    const double *prefetched = values + points[std::min(n + 32, piece.end - 1)].offset;
    for (int f = 0; f < Fields; ++f)
      for (const std::ptrdiff_t side : {-slice, slice}) __builtin_prefetch(prefetched + f * size + side);
    double *b = values + point.offset;
    double sum[Fields] = {};
    for (int d = 0; d < dimension; ++d) {  // pairs first, so that a mirrored scene gives mirrored bits
      const unsigned pair = point.neighbours >> (2 * d), linear = point.lines >> (2 * d);
      double pair_sum[Fields] = {};
      if (pair & 1)
        for (int f = 0; f < Fields; ++f) pair_sum[f] = extrapolated(b + f * size, -stride[d], linear & 1);
      if (pair & 2)
        for (int f = 0; f < Fields; ++f) pair_sum[f] += extrapolated(b + f * size, stride[d], linear >> 1 & 1);
      for (int f = 0; f < Fields; ++f) sum[f] += pair_sum[f];
    }
    const int count = __builtin_popcount(point.neighbours);
    flops += count;
    if (point.lines) flops += 7 * __builtin_popcount(point.lines);
    for (int f = 0; f < Fields; ++f) b[f * size] = sum[f] / count;
  }
  return Fields * static_cast<double>(flops);
}

}  // namespace eulastic
