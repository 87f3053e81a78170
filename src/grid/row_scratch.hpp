// Scratch memory for a few rows, which stay in the first-level cache and have the same indices as rows of a field.
#pragma once

#include "grid/box.hpp"

#include <cstdlib>
#include <memory>

namespace eulastic {

/// Owns `rows` rows of scratch for a box.
class RowScratch {
public:
  RowScratch(const Box &box, int rows)
      : length_((box.cells()[0] + 3 * 8 + 7) / 8 * 8),
        data_(static_cast<double *>(std::aligned_alloc(64, sizeof(double) * length_ * rows)), std::free) {}
  /// Returns row r, valid for -8 <= i < cells + 8.
  double *row(int r) const noexcept { return data_.get() + r * length_ + 8; }

private:
  std::ptrdiff_t length_;
  std::unique_ptr<double, void (*)(void *)> data_;
};

}  // namespace eulastic
