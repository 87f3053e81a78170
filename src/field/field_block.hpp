// Fields of one group in one contiguous, ghosted, zero-initialised structure-of-arrays block.
#pragma once

#include "grid/grid.hpp"

#include <cstdlib>
#include <memory>
#include <utility>

namespace eulastic {

class FieldBlock {
public:
  FieldBlock() = default;
  /// `count` fields on `grid`, all zero, 64-byte aligned.
  FieldBlock(const Grid &grid, int count);

  explicit operator bool() const noexcept { return data_ != nullptr; }
  int count() const noexcept { return count_; }
  const Layout &layout() const noexcept { return layout_; }
  double *data() noexcept { return data_.get(); }
  const double *data() const noexcept { return data_.get(); }
  /// Memory of its own: 0 for a part of another block.
  std::size_t bytes() const noexcept { return data_.get_deleter().borrowed ? 0 : size() * sizeof(double); }

  [[gnu::always_inline]] View operator[](int f) noexcept {
    return {data_.get() + f * layout_.size + layout_.origin, layout_.sy, layout_.sz};
  }
  [[gnu::always_inline]] ConstView operator[](int f) const noexcept {
    return {data_.get() + f * layout_.size + layout_.origin, layout_.sy, layout_.sz};
  }

  /// Sets field f to one value, ghosts and padding included.
  void fill(int f, double value) noexcept;
  /// Sets everything to 0.
  void clear() noexcept;
  /// Fields first ... first + count - 1 as a block that shares this one's memory; must not outlive it.
  FieldBlock part(int first, int count) noexcept;
  /// Makes this an equal block of its own memory.
  void copy_from(const FieldBlock &other);
  void swap(FieldBlock &other) noexcept { std::swap(*this, other); }

private:
  struct Free {
    bool borrowed;
    void operator()(double *p) const noexcept {
      if (!borrowed) std::free(p);
    }
  };
  static double *allocate(std::size_t values);
  std::size_t size() const noexcept { return layout_.size * static_cast<std::size_t>(count_); }
  Layout layout_;
  int count_ = 0;
  std::unique_ptr<double[], Free> data_;
};

}  // namespace eulastic
