#include "field/field_block.hpp"

#include <algorithm>
#include <new>

namespace eulastic {

FieldBlock::FieldBlock(const Grid &grid, int count) : layout_(grid.layout()), count_(count) {
  data_.reset(static_cast<double *>(std::aligned_alloc(64, bytes())));
  if (!data_) throw std::bad_alloc();
  std::fill_n(data_.get(), layout_.size * count_, 0.0);
}

void FieldBlock::fill(int f, double value) noexcept {
  std::fill_n(data_.get() + f * layout_.size, layout_.size, value);
}

}  // namespace eulastic
