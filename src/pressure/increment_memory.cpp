#include "pressure/increment_memory.hpp"

#include "field/open_boundaries.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace eulastic {

IncrementMemory::IncrementMemory(const Box &box, int count) {
  if (count > 0) block_ = Field(box, count);
}

Field *IncrementMemory::saved() {
  if (!block_) return nullptr;
  const std::size_t size = block_.layout().size;
  double *data = block_.data();
  std::rotate(data, data + newest_ * size, data + count() * size);
  newest_ = 0;
  return &block_;
}

void IncrementMemory::clear() {
  if (block_) block_.clear();
  ghosts_valid_ = false;
}

PetscErrorCode IncrementMemory::update_ghosts(const Box &box, GhostExchange &exchange) {
  PetscFunctionBeginUser;
  if (std::exchange(ghosts_valid_, true)) PetscFunctionReturn(0);
  PetscCall(exchange.update_ghosts(block_, 1));
  for (int f = 0; f < count(); ++f) fill_ghosts_of_increment(box, block_[f], 1);
  PetscFunctionReturn(0);
}

// Cholesky decomposition of the Gram matrix, row by row, omitting dependent rows.
LeastSquaresSolution minimise(const LeastSquaresSums &s) {
  constexpr double parallel = 1e-12, rounding = 1e-14;
  constexpr int most = LeastSquaresSums::most;
  LeastSquaresSolution minimum;
  double lower[most][most] = {}, y[most] = {};
  bool used[most] = {};
  double gain = 0;
  for (int i = 0; i < s.directions; ++i) {
    double pivot = s.product[i][i], right = s.with[i];
    for (int j = 0; j < i; ++j) {
      if (!used[j]) continue;
      lower[i][j] = s.product[i][j];
      for (int m = 0; m < j; ++m) lower[i][j] -= lower[i][m] * lower[j][m];
      lower[i][j] /= lower[j][j];
      pivot -= lower[i][j] * lower[i][j];
      right -= lower[i][j] * y[j];
    }
    used[i] = !(pivot <= parallel * s.product[i][i]);  // NaN is used and propagates
    if (!used[i]) {
      std::fill_n(lower[i], most, 0.0);
      continue;
    }
    lower[i][i] = std::sqrt(pivot);
    y[i] = right / lower[i][i];
    gain += y[i] * y[i];
  }
  for (int i = s.directions - 1; i >= 0; --i) {
    if (!used[i]) continue;
    double right = y[i];
    for (int m = i + 1; m < s.directions; ++m) right -= lower[m][i] * minimum.coefficient[m];
    minimum.coefficient[i] = right / lower[i][i];
  }
  minimum.square = s.square - gain;
  if (minimum.square < rounding * s.square) minimum.square = rounding * s.square;
  if (!std::isfinite(minimum.square)) std::fill_n(minimum.coefficient, most, std::nan(""));
  return minimum;
}

}  // namespace eulastic
