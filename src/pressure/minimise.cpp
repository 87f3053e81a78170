#include "pressure/minimise.hpp"

#include <algorithm>
#include <cmath>

namespace eulastic {

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
