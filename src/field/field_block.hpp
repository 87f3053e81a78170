// Fields of one group in one contiguous, ghosted, zero-initialised structure-of-arrays block.
#pragma once

#include "grid/box.hpp"

#include <cstddef>
#include <memory>
#include <utility>

namespace eulastic {

class FieldBlock {
public:
  FieldBlock() = default;
  /// `count` fields on `grid`, all zero, 64-byte aligned.
  FieldBlock(const Box &box, int count);
  /// The same, but 1 in the first `ones` fields, and memory follows what is written: pages that are only read, or not
  /// even that, take none. For what differs from its rest near bodies alone.
  static FieldBlock at_rest(const Box &box, int count, int ones = 0);

  explicit operator bool() const noexcept { return data_ != nullptr; }
  int count() const noexcept { return count_; }
  const Layout &layout() const noexcept { return layout_; }
  double *data() noexcept { return data_.get(); }
  const double *data() const noexcept { return data_.get(); }
  /// Memory of its own: 0 for a part of another block.
  std::size_t bytes() const noexcept { return data_.get_deleter().borrowed ? 0 : size() * sizeof(double); }

  /// All memory of field f, ghosts and padding included.
  double *field(int f) noexcept { return data_.get() + f * layout_.size; }
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
  /// Moves what is at rest to memory like that of other blocks, which is there from the start and faster.
  void leave_rest();
  /// Makes this an equal block of its own memory, at rest where the other one is.
  void copy_from(const FieldBlock &other);
  void swap(FieldBlock &other) noexcept { std::swap(*this, other); }

private:
  struct Free {
    bool borrowed;
    std::size_t mapped;  ///< bytes, 0: of the heap
    void operator()(double *p) const noexcept;
  };
  using Memory = std::unique_ptr<double[], Free>;
  static Memory allocate(std::size_t values);
  static Memory allocate_at_rest(std::size_t values, std::size_t ones);
  void copy(const double *values, bool is_new);
  std::size_t size() const noexcept { return layout_.size * static_cast<std::size_t>(count_); }
  Layout layout_;
  int count_ = 0;
  bool rests_ = false;  ///< in pages of at_rest()
  int ones_ = 0;        ///< first fields that rest at 1
  Memory data_;
};

}  // namespace eulastic
