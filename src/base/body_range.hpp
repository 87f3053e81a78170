// The block of bodies that a rank owns. Measures of a body are gathered on its owner.
#pragma once

#include <algorithm>
#include <cstdint>

namespace eulastic {

/// Bodies begin <= n < end of a block distribution, with indices over all bodies.
struct BodyRange {
  int begin = 0, end = 0;
  int size() const { return end - begin; }
  static constexpr int piece = 131072;  ///< number of bodies that one rank gathers at a time
  /// The intersection with [first, last).
  BodyRange within(int first, int last) const { return {std::clamp(first, begin, end), std::clamp(last, begin, end)}; }
  bool has(int body) const { return body >= begin && body < end; }
  /// The bodies that rank `rank` of `ranks` owns if there are `bodies`.
  static BodyRange of(int bodies, int rank, int ranks) {
    const auto bound = [&](int r) { return static_cast<int>(std::int64_t(bodies) * r / ranks); };
    return {bound(rank), bound(rank + 1)};
  }
  /// The rank that owns `body`.
  static int owner(int body, int bodies, int ranks) {
    return static_cast<int>(((std::int64_t(body) + 1) * ranks - 1) / bodies);
  }
};

}  // namespace eulastic
