// Masks of one bit a point, against loops over single points.
#include "grid/bit_rows.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

namespace eulastic {
namespace {

using Word = BitRows::Word;

std::vector<bool> bits_of(const std::vector<Word> &row) {
  std::vector<bool> bits;
  for (std::size_t b = 0; b < row.size() * BitRows::word_bits; ++b)
    bits.push_back(is_set(static_cast<int>(b), row.data()));
  return bits;
}
std::vector<Word> random_row(int words, std::mt19937_64 &random) {
  std::vector<Word> row(words);
  for (Word &word : row) word = random() & random();
  return row;
}

TEST(BitRows, SetsRangesAndSingleBits) {
  for (const auto &[begin, end] :
       {std::array<int, 2>{0, 0}, {0, 64}, {3, 5}, {60, 70}, {64, 128}, {1, 192}, {191, 192}}) {
    std::vector<Word> row(3, 0);
    set_bits(begin, end, row.data());
    for (int b = 0; b < 192; ++b)
      EXPECT_EQ(is_set(b, row.data()), b >= begin && b < end) << begin << " " << end << " " << b;
    if (begin == end) continue;
    clear_bit(end - 1, row.data());
    EXPECT_FALSE(is_set(end - 1, row.data()));
  }
}

// Comparisons at any position in a row, with values that are not numbers; nothing is set beyond the last one.
TEST(BitRows, SetsBitsWhereATestIsTrue) {
  std::mt19937_64 random(1);
  std::vector<double> values(200);
  for (double &value : values) value = static_cast<double>(random() % 5) / 4;
  values[17] = std::numeric_limits<double>::quiet_NaN();
  for (const int at : {0, 1, 7, 57, 60, 63, 64, 90})
    for (const int n : {0, 1, 4, 7, 8, 9, 63, 64, 65, 100}) {
      std::vector<Word> row(3, 0), other(3, 0);
      set_where(
          n, at, [&](int i) { return load_four(values.data() + i) >= 0.5; }, row.data());
      set_where(
          n, at, [&](int i) { return load_four(values.data() + i) != 1; }, other.data());
      for (int b = 0; b < 192; ++b) {
        const bool inside = b >= at && b < at + n;
        EXPECT_EQ(is_set(b, row.data()), inside && values[b - at] >= 0.5) << at << " " << n << " " << b;
        EXPECT_EQ(is_set(b, other.data()), inside && values[b - at] != 1) << at << " " << n << " " << b;
      }
    }
}

TEST(BitRows, SpreadsAndMoves) {
  std::mt19937_64 random(2);
  for (const int words : {1, 2, 3}) {
    const std::vector<Word> row = random_row(words, random);
    const std::vector<bool> before = bits_of(row);
    const int bits = words * BitRows::word_bits;
    for (const int reach : {0, 1, 2, 5, 9}) {
      std::vector<Word> wide = row;
      spread_bits(reach, words, wide.data());
      for (int b = 0; b < bits; ++b) {
        bool any = false;
        for (int d = 0; d <= reach && b + d < bits; ++d) any = any || before[b + d];
        EXPECT_EQ(is_set(b, wide.data()), any) << words << " " << reach << " " << b;
      }
    }
    BitRows mask;
    mask.reset({{-5, 2, 1}, {bits - 5, 4, 3}});
    ASSERT_EQ(mask.words(), words);
    std::copy(row.begin(), row.end(), mask.row(3, 2));
    for (const int step : {-3, -1, 0, 1, 2})
      for (int b = 0; b < bits; ++b) {
        const Word moved = mask.moved_word(3, 2, b / BitRows::word_bits, step);
        const bool expected = b + step >= 0 && b + step < bits && before[b + step];
        EXPECT_EQ(moved >> (b % BitRows::word_bits) & 1, expected) << words << " " << step << " " << b;
      }
  }
}

TEST(BitRows, SpreadsRows) {
  std::mt19937_64 random(3);
  constexpr int words = 2, rows = 7;
  const std::vector<Word> plane = random_row(words * rows, random);
  for (const int reach : {0, 1, 3, 4}) {
    std::vector<Word> wide = plane;
    spread_rows(reach, words, rows, wide.data());
    for (int n = 0; n < words * rows; ++n) {
      Word any = 0;
      for (int d = 0; d <= reach && n + d * words < words * rows; ++d) any |= plane[n + d * words];
      EXPECT_EQ(wide[n], any) << reach << " " << n;
    }
  }
}

TEST(BitRows, ExchangesBytesAndBits) {
  std::mt19937_64 random(4);
  for (int turn = 0; turn < 100; ++turn) {
    const Word bytes = random(), exchanged = transposed(bytes);
    for (int n = 0; n < 8; ++n)
      for (int b = 0; b < 8; ++b) EXPECT_EQ(exchanged >> (8 * b + n) & 1, bytes >> (8 * n + b) & 1);
  }
}

}  // namespace
}  // namespace eulastic
