// A field on a box of cells: the components of a vector or tensor, or a group of scalars, in one allocation, component
// after component, with ghosts.
//
// The DMDA determines the cells of a rank, the points that ghosts copy, and global Vecs (grid/domain.hpp,
// field/ghost_exchange.hpp, field/global_vector.hpp). The memory layout differs from a local Vec: rows are padded to
// whole cache lines, because vector loads across cache lines would cost several per cent of a step.
#pragma once

#include "grid/box.hpp"

#include <cstddef>
#include <memory>
#include <utility>

namespace eulastic {

/// Owns the memory of its components, except for parts and fields in memory of another owner.
class Field {
public:
  Field() = default;
  /// `count` components on `box`, all zero, 64-byte aligned.
  Field(const Box &box, int count);
  /// Returns a field with the defaults 1 in the first `ones` components and 0 in the others, whose memory is allocated
  /// on demand: pages that are only read take none. For fields that differ from their defaults only near bodies.
  static Field on_demand(const Box &box, int count, int ones = 0);

  /// Returns a field of `count` components on `box` in memory of another owner, with the values in that memory.
  static Field in_memory(const Box &box, int count, double *memory) noexcept;

  explicit operator bool() const noexcept { return data_ != nullptr; }
  int count() const noexcept { return count_; }
  const Layout &layout() const noexcept { return layout_; }
  double *data() noexcept { return data_.get(); }
  const double *data() const noexcept { return data_.get(); }
  /// Bytes that the field owns: 0 for a part of another field.
  std::size_t bytes() const noexcept { return data_.get_deleter().borrowed ? 0 : size() * sizeof(double); }

  /// Returns a view of component f.
  [[gnu::always_inline]] View operator[](int f) noexcept {
    return {data_.get() + f * layout_.size + layout_.origin, layout_.sy, layout_.sz};
  }
  [[gnu::always_inline]] ConstView operator[](int f) const noexcept {
    return {data_.get() + f * layout_.size + layout_.origin, layout_.sy, layout_.sz};
  }

  /// Sets component f to one value, including ghosts and padding.
  void fill(int f, double value) noexcept;
  /// Sets all memory to 0.
  void clear() noexcept;
  /// Returns components first ... first + count - 1 as a field that shares the memory of this one and must not outlive
  /// it.
  Field part(int first, int count) noexcept;
  /// Moves a field made by Field::on_demand() to memory that is allocated at once, with faster access.
  void allocate_fully();
  /// Makes this a copy of another field of the same kind, in memory of its own.
  void copy_from(const Field &other);
  void swap(Field &other) noexcept { std::swap(*this, other); }

private:
  struct Deleter {
    bool borrowed;
    std::size_t mapped;  ///< bytes of mapped memory; 0: allocated on the heap
    void operator()(double *p) const noexcept;
  };
  using Memory = std::unique_ptr<double[], Deleter>;
  static Memory allocate(std::size_t values);
  static Memory allocate_on_demand(std::size_t values, std::size_t ones);
  void copy(const double *values, bool is_new);
  std::size_t size() const noexcept { return layout_.size * static_cast<std::size_t>(count_); }
  Layout layout_;
  int count_ = 0;
  bool on_demand_ = false;  ///< made by Field::on_demand()
  int ones_ = 0;            ///< number of leading components whose default is 1
  Memory data_;
};

/// A field to which a contribution is added with a factor, such as a force to the rate of momentum or to its change in
/// time. Null: no field.
struct WeightedTarget {
  Field *field = nullptr;
  double factor = 0;
};

}  // namespace eulastic
