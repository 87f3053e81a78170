// A mask of the points of a block, one bit each, in rows of 64-bit words: one operation works on 64 points.
#pragma once

#include "grid/box.hpp"

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <vector>

#ifdef __AVX2__
#include <immintrin.h>
#endif

namespace eulastic {

/// Owns a bit for every point of a block. Bit b of a row, counted from the lowest bit of its first word, is point
/// begin[0] + b; bits beyond the block are 0.
class BitRows {
public:
  using Word = std::uint64_t;
  static constexpr int word_bits = 64;
  static int words_for(int bits) noexcept { return (bits + word_bits - 1) / word_bits; }

  /// Makes this the mask of a block, without any bit set.
  void reset(const Extent &block);
  int words() const noexcept { return words_; }  ///< in a row
  int begin_x() const noexcept { return block_.begin[0]; }
  Word *row(int j, int k) noexcept { return bits_.data() + offset(j, k); }
  const Word *row(int j, int k) const noexcept { return bits_.data() + offset(j, k); }

  /// Returns word w of row (j, k) moved by `step` bits, less than a word: bit b is bit b + step of the row.
  Word moved_word(int j, int k, int w, int step) const noexcept {
    const Word *bits = row(j, k) + w;
    if (step >= 0) return step == 0 ? *bits : *bits >> step | (w + 1 < words_ ? bits[1] << (word_bits - step) : 0);
    return *bits << -step | (w > 0 ? bits[-1] >> (word_bits + step) : 0);
  }
  std::ptrdiff_t words_in_plane() const noexcept { return std::ptrdiff_t(words_) * (block_.end[1] - block_.begin[1]); }

private:
  std::size_t offset(int j, int k) const noexcept {
    const std::size_t rows = block_.end[1] - block_.begin[1];
    return words_ * ((j - block_.begin[1]) + rows * (k - block_.begin[2]));
  }
  Extent block_{};
  int words_ = 0;
  std::vector<Word> bits_;
};

/// Returns the bits begin ... end - 1 of word w of a row.
inline BitRows::Word bits_between(int begin, int end, int w) noexcept {
  const int low = std::max(begin - w * BitRows::word_bits, 0);
  const int high = std::min(end - w * BitRows::word_bits, BitRows::word_bits);
  return low < high ? ~BitRows::Word{0} >> (BitRows::word_bits - (high - low)) << low : 0;
}
/// Sets the bits begin ... end - 1 of a row.
void set_bits(int begin, int end, BitRows::Word *row) noexcept;
inline bool is_set(int bit, const BitRows::Word *row) noexcept {
  return row[bit / BitRows::word_bits] >> (bit % BitRows::word_bits) & 1;
}
inline void clear_bit(int bit, BitRows::Word *row) noexcept {
  row[bit / BitRows::word_bits] &= ~(BitRows::Word{1} << (bit % BitRows::word_bits));
}
/// Sets every bit of a row to the logical or of itself and the `reach` bits above it.
void spread_bits(int reach, int words, BitRows::Word *row) noexcept;
/// Sets every row of a plane to the logical or of itself and the `reach` rows after it, as far as there are.
void spread_rows(int reach, int words, int rows, BitRows::Word *plane) noexcept;

/// Returns 8 bytes of 8 bits with bytes and bits exchanged: bit n of byte b is bit b of byte n.
inline BitRows::Word transposed(BitRows::Word bytes) noexcept {
  const auto exchange = [&bytes](int step, BitRows::Word high) {
    const BitRows::Word differ = (bytes ^ bytes >> step) & high;
    bytes ^= differ ^ differ << step;
  };
  exchange(7, 0x00AA00AA00AA00AA);
  exchange(14, 0x0000CCCC0000CCCC);
  exchange(28, 0x00000000F0F0F0F0);
  return bytes;
}

/// Four consecutive values of a row.
using Four = double __attribute__((vector_size(32)));
inline Four load_four(const double *values) noexcept {
  Four four;
  std::memcpy(&four, values, sizeof(four));
  return four;
}
/// Sets the bits at, at + 1, ..., at + n - 1 of a row of zeros where a comparison is true: test(i) compares the values
/// of i ... i + 3, like `load_four(row + i) >= threshold`, also up to 7 beyond n.
template <class Test>
void set_where(int n, int at, const Test &test, BitRows::Word *row) noexcept {
  const auto bits_of = [&test](int i) -> BitRows::Word {
    const auto mask = test(i);
#ifdef __AVX2__
    return _mm256_movemask_pd(reinterpret_cast<__m256d>(mask));
#else
    return (mask[0] & 1) | (mask[1] & 2) | (mask[2] & 4) | (mask[3] & 8);
#endif
  };
  for (int i = 0; i < n; i += 8, at += 8) {
    const BitRows::Word bits = (bits_of(i) | bits_of(i + 4) << 4) & bits_between(0, n - i, 0);
    const int w = at / BitRows::word_bits, low = at % BitRows::word_bits;
    row[w] |= bits << low;
    if (low > BitRows::word_bits - 8 && bits >> (BitRows::word_bits - low) != 0)
      row[w + 1] |= bits >> (BitRows::word_bits - low);
  }
}

}  // namespace eulastic
