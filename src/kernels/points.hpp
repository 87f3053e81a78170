// The points that a kernel processes: a piece of a row, or vectors of points from several rows in one loop.
#pragma once

#include "grid/segment.hpp"
#include "kernels/isa.hpp"

namespace eulastic::kernels {

/// Vectors of 8 points, stored as offsets from the origin of a field. Segments of a body are a few vectors long, and
/// entering a loop costs as much as processing three vectors; a batch enters it once for many segments.
struct Batch {
  static constexpr int width = 8, vectors = 64, points = width * vectors;
  std::ptrdiff_t first[vectors];
  int count = 0;
  int size = width;  ///< points of each vector; fewer only at the ends of rows
  /// Fields to prefetch into the second-level cache at the offsets of each vector when a loop reaches it, because many
  /// prefetches at once would wait for each other. Null: none.
  const double *ahead[2] = {nullptr, nullptr};
};

/// Adds the points [begin, end) of a row to the batch and calls work(batch) whenever it is full. A remainder of a row
/// that does not fill a vector is processed at once. Call work(batch) after the last row.
template <class Work>
EULASTIC_INLINE void gather(Batch &batch, std::ptrdiff_t row, int begin, int end, Work work) {
  for (int i = begin; i < end; i += Batch::width) {
    if (end - i < Batch::width) {
      Batch rest;
      rest.size = end - i;
      rest.first[rest.count++] = row + i;
      work(rest);
    } else {
      batch.first[batch.count++] = row + i;
      if (batch.count < Batch::vectors) continue;
      work(batch);
      batch.count = 0;
    }
  }
}

/// Calls body(offset, slot) for the points of a segment: offset from the origin of q and of every field with its
/// layout, slot = i.
template <class Body>
EULASTIC_INLINE void for_points(const Segment &s, ConstView q, Body body) noexcept {
  const std::ptrdiff_t row = s.j * q.sy + s.k * q.sz;
#pragma omp simd
  for (int i = s.i_begin; i < s.i_end; ++i) body(row + i, i);
}

/// Calls body(offset, slot) for the points of a batch; slots count from 0, eight for every vector.
template <class Body>
EULASTIC_INLINE void for_points(const Batch &batch, ConstView, Body body) noexcept {
  if (batch.size == Batch::width) {
    const double *one = batch.ahead[0], *other = batch.ahead[1];
    for (int n = 0; n < batch.count; ++n) {
      const std::ptrdiff_t first = batch.first[n];
      if (one) __builtin_prefetch(one + first, 0, 2);
      if (other) __builtin_prefetch(other + first, 0, 2);
#pragma omp simd
      for (int i = 0; i < Batch::width; ++i) body(first + i, Batch::width * n + i);
    }
  } else {
    for (int n = 0; n < batch.count; ++n)
      for (int i = 0; i < batch.size; ++i) body(batch.first[n] + i, Batch::width * n + i);
  }
}

}  // namespace eulastic::kernels
