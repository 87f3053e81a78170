// Which of all bodies a rank owns: what is known of them is known there.
#pragma once

#include <algorithm>
#include <cstdint>

namespace eulastic {

/// Bodies [begin, end), indices over all of them.
struct BodyRange {
  int begin = 0, end = 0;
  int size() const { return end - begin; }
  static constexpr int piece = 131072;  ///< bodies that ranks send to one at a time
  /// What it has of [first, last).
  BodyRange within(int first, int last) const { return {std::clamp(first, begin, end), std::clamp(last, begin, end)}; }
  bool has(int body) const { return body >= begin && body < end; }
  /// Of rank `rank` of `ranks`, of `bodies`.
  static BodyRange of(int bodies, int rank, int ranks) {
    const auto bound = [&](int r) { return static_cast<int>(std::int64_t(bodies) * r / ranks); };
    return {bound(rank), bound(rank + 1)};
  }
  /// The rank whose range has `body`.
  static int owner(int body, int bodies, int ranks) {
    return static_cast<int>(((std::int64_t(body) + 1) * ranks - 1) / bodies);
  }
};

}  // namespace eulastic
