// Extrapolation layer by layer: points of a layer take the mean of their face neighbours in the layers before.
#pragma once

#include "base/petsc.hpp"
#include "grid/threads.hpp"
#include "kernels/stencils.hpp"

#include <algorithm>
#include <cstdint>
#include <vector>

namespace eulastic {

/// A point of a layer, and which of its neighbours count.
struct LayerPoint {
  PetscInt offset;           ///< from the field's first double
  unsigned char neighbours;  ///< neighbour_bits()
  unsigned char lines;       ///< those of them with two points more behind: there the extrapolation is linear
  LayerPoint(std::ptrdiff_t at, unsigned from, unsigned along) noexcept
      : offset(static_cast<PetscInt>(at)),
        neighbours(static_cast<unsigned char>(from)),
        lines(static_cast<unsigned char>(along)) {}
};

/// Bits of the neighbours for which counts(step) holds: low x, high x, low y, high y, low z, high z.
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

/// The mean over the neighbours of every point of a layer, of `Fields` components on the same points, `size` doubles
/// apart from `values` on. Returns the flops: of n values one each, seven more of a line.
template <int Fields>
double extend_layer(const std::vector<LayerPoint> &points, Piece piece, int dimension, const std::ptrdiff_t *stride,
                    std::ptrdiff_t size, double *values) {
  std::int64_t flops = 0;
  const std::ptrdiff_t slice = stride[dimension - 1];
  for (std::size_t n = piece.begin; n < piece.end; ++n) {
    const LayerPoint &point = points[n];
    const double *later = values + points[std::min(n + 32, piece.end - 1)].offset;
    for (int f = 0; f < Fields; ++f)
      for (const std::ptrdiff_t side : {-slice, slice}) __builtin_prefetch(later + f * size + side);
    double *b = values + point.offset;
    double sum[Fields] = {};
    for (int d = 0; d < dimension; ++d) {  // the pair first: a mirrored scene gives the mirrored bits
      const unsigned pair = point.neighbours >> (2 * d), linear = point.lines >> (2 * d);
      double both[Fields] = {};
      if (pair & 1)
        for (int f = 0; f < Fields; ++f) both[f] = extrapolated(b + f * size, -stride[d], linear & 1);
      if (pair & 2)
        for (int f = 0; f < Fields; ++f) both[f] += extrapolated(b + f * size, stride[d], linear >> 1 & 1);
      for (int f = 0; f < Fields; ++f) sum[f] += both[f];
    }
    const int count = __builtin_popcount(point.neighbours);
    flops += count;
    if (point.lines) flops += 7 * __builtin_popcount(point.lines);
    for (int f = 0; f < Fields; ++f) b[f * size] = sum[f] / count;
  }
  return Fields * static_cast<double>(flops);
}

}  // namespace eulastic
