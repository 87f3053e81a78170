#include "grid/bit_rows.hpp"

#include <algorithm>

namespace eulastic {

void BitRows::reset(const Extent &block) {
  block_ = block;
  words_ = words_for(block.end[0] - block.begin[0]);
  bits_.assign(words_ * std::size_t(block.end[1] - block.begin[1]) * std::size_t(block.end[2] - block.begin[2]), 0);
}

void set_bits(int begin, int end, BitRows::Word *row) noexcept {
  for (int w = begin / BitRows::word_bits; w < BitRows::words_for(end); ++w) row[w] |= bits_between(begin, end, w);
}

void spread_bits(int reach, int words, BitRows::Word *row) noexcept {
  for (int done = 1, step; done <= reach; done += step) {  // `done` bits are combined already, of reach + 1
    step = std::min(done, reach + 1 - done);
    for (int w = 0; w < words; ++w)
      row[w] |= row[w] >> step | (w + 1 < words ? row[w + 1] << (BitRows::word_bits - step) : 0);
  }
}

void spread_rows(int reach, int words, int rows, BitRows::Word *plane) noexcept {
  for (int done = 1, step; done <= reach; done += step) {  // `done` rows are combined already, of reach + 1
    step = std::min(done, reach + 1 - done);
    for (int n = 0; n < words * (rows - step); ++n) plane[n] |= plane[n + words * step];
  }
}

}  // namespace eulastic
