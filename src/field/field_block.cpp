#include "field/field_block.hpp"

#include <algorithm>
#include <new>

namespace eulastic {

FieldBlock::FieldBlock(const Grid &grid, int count) : layout_(grid.layout()), count_(count) {
  data_.reset(static_cast<double *>(std::aligned_alloc(64, size() * sizeof(double))));
  if (!data_) throw std::bad_alloc();
  std::fill_n(data_.get(), layout_.size * count_, 0.0);
}

FieldBlock FieldBlock::part(int first, int count) noexcept {
  FieldBlock block;
  block.layout_ = layout_;
  block.count_ = count;
  block.data_ = {data_.get() + first * layout_.size, Free{true}};
  return block;
}

void FieldBlock::fill(int f, double value) noexcept {
  std::fill_n(data_.get() + f * layout_.size, layout_.size, value);
}

void FieldBlock::clear() noexcept { std::fill_n(data_.get(), layout_.size * count_, 0.0); }

void FieldBlock::copy_from(const FieldBlock &other) {
  if (count_ != other.count_ || layout_.size != other.layout_.size) {
    data_ = {static_cast<double *>(std::aligned_alloc(64, other.size() * sizeof(double))), Free{}};
    if (!data_) throw std::bad_alloc();
  }
  layout_ = other.layout_;
  count_ = other.count_;
  std::copy_n(other.data_.get(), layout_.size * count_, data_.get());
}

}  // namespace eulastic
