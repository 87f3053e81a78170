// Least squares over a few directions, from the sums of a pressure iteration.
#pragma once

namespace eulastic {

/// Sums over all cells for the minimum of |D - sum c_i L_i|^2: square = <D^2>, with[i] = <D L_i>, product[i][j] = <L_i
/// L_j> (j <= i).
struct LeastSquaresSums {
  static constexpr int most = 4;
  int directions = 0;
  double square = 0, with[most] = {}, product[most][most] = {};
};
struct LeastSquaresSolution {
  double coefficient[LeastSquaresSums::most] = {};
  double square = 0;  ///< <(D - sum c_i L_i)^2>, at least the rounding of the sums, 1e-14 <D^2>
};
/// Computes the coefficients c_i of the minimum. Directions that are zero or depend on earlier ones get 0; all are NaN
/// if the sums are not finite.
LeastSquaresSolution minimise(const LeastSquaresSums &sums);

}  // namespace eulastic
