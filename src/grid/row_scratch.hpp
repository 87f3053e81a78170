// A few rows of scratch that stay in the first-level cache; indexed like the rows of a field.
#pragma once

#include "grid/box.hpp"

#include <cstdlib>
#include <memory>

namespace eulastic {

/// n rounded up to a multiple of what the widest vectors hold of bytes: what is left of a row after them, done one by
/// one, would often be most of it.
constexpr int whole_vectors(int n) { return (n + 63) / 64 * 64; }

class RowScratch {
public:
  RowScratch(const Box &box, int rows)
      : length_((box.cells()[0] + 3 * 8 + 7) / 8 * 8),
        data_(static_cast<double *>(std::aligned_alloc(64, sizeof(double) * length_ * rows)), std::free) {}
  /// Row r; valid for -8 <= i < owned + 8.
  double *row(int r) const noexcept { return data_.get() + r * length_ + 8; }

private:
  std::ptrdiff_t length_;
  std::unique_ptr<double, void (*)(void *)> data_;
};

}  // namespace eulastic
