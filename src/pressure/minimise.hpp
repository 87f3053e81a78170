// Least squares over a few directions, from the sums of a sweep.
#pragma once

namespace eulastic {

/// Least squares of |D - sum c_i L_i|^2 from sums over all cells: square = <D^2>, with[i] = <D L_i>,
/// product[i][j] = <L_i L_j> (j <= i).
struct SweepSums {
  static constexpr int most = 4;
  int directions = 0;
  double square = 0, with[most] = {}, product[most][most] = {};
};
struct SweepMinimum {
  double coefficient[SweepSums::most] = {};
  double square = 0;  ///< <(D - sum c_i L_i)^2>; never below the rounding of the sums, 1e-14 <D^2>
};
/// Directions that are zero, or depend on the ones before them, get the coefficient 0; all are NaN if the sums are.
SweepMinimum minimise(const SweepSums &sums);

}  // namespace eulastic
