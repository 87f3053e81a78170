// A field on a box of cells: the components of a vector or tensor, or a group of scalars, in one allocation, component
// after component, with ghosts.
//
// Which cells a rank has, which points its ghosts copy and what a global Vec looks like is the DMDA's (grid/domain.hpp,
// field/ghost_exchange.hpp, field/global_vector.hpp). Only memory is laid out differently from a local Vec: rows are
// padded to whole cache lines, as vector loads that cross lines would cost several per cent of a step.
#pragma once

#include "grid/box.hpp"

#include <cstddef>
#include <memory>
#include <utility>

namespace eulastic {

class Field {
public:
  Field() = default;
  /// `count` components on `box`, all zero, 64-byte aligned.
  Field(const Box &box, int count);
  /// The same, but 1 in the first `ones` components, and memory is taken as it is written: pages that are only read
  /// take none. For fields that keep these values everywhere but near bodies.
  static Field at_rest(const Box &box, int count, int ones = 0);

  /// `count` components on `box` in memory that somebody else owns, with the values that it has.
  static Field in_memory(const Box &box, int count, double *memory) noexcept;

  explicit operator bool() const noexcept { return data_ != nullptr; }
  int count() const noexcept { return count_; }
  const Layout &layout() const noexcept { return layout_; }
  double *data() noexcept { return data_.get(); }
  const double *data() const noexcept { return data_.get(); }
  /// Memory that it owns: 0 for a part of another field.
  std::size_t bytes() const noexcept { return data_.get_deleter().borrowed ? 0 : size() * sizeof(double); }

  /// Component f.
  [[gnu::always_inline]] View operator[](int f) noexcept {
    return {data_.get() + f * layout_.size + layout_.origin, layout_.sy, layout_.sz};
  }
  [[gnu::always_inline]] ConstView operator[](int f) const noexcept {
    return {data_.get() + f * layout_.size + layout_.origin, layout_.sy, layout_.sz};
  }

  /// Sets component f to one value, ghosts and padding included.
  void fill(int f, double value) noexcept;
  /// Sets all memory to 0.
  void clear() noexcept;
  /// Components first ... first + count - 1 as a field that shares this one's memory and must not outlive it.
  Field part(int first, int count) noexcept;
  /// Moves a field made by at_rest() to memory like that of other fields, which is allocated at once and faster.
  void leave_rest();
  /// Makes this a copy of another field in memory of its own, of the same kind.
  void copy_from(const Field &other);
  void swap(Field &other) noexcept { std::swap(*this, other); }

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
  bool rests_ = false;  ///< made by at_rest()
  int ones_ = 0;        ///< leading components that were 1 at first
  Memory data_;
};

/// A field to which something is added `factor` times, as a force to the rate of momentum or to its change in time.
/// Null: nowhere.
struct WeightedTarget {
  Field *field = nullptr;
  double factor = 0;
};

}  // namespace eulastic
