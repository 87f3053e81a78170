// The pressure increments of the last steps, which are the first search directions of a solve.
#pragma once

#include "base/petsc.hpp"
#include "field/ghost_exchange.hpp"

namespace eulastic {

class IncrementMemory {
public:
  IncrementMemory() = default;
  /// Memory for `count` steps; 0: none.
  IncrementMemory(const Box &box, int count);
  explicit operator bool() const { return bool(block_); }
  int count() const { return block_.count(); }
  std::size_t bytes() const { return block_.bytes(); }
  /// The increment of n + 1 steps ago, 0 <= n < count; after advance() that of n steps ago.
  Field increment(int n) { return block_.part((newest_ + n) % count(), 1); }
  /// Makes room for the increment of this step in place of the oldest one; its values are undefined until it is set.
  void advance() { newest_ = (newest_ + count() - 1) % count(); }
  /// All increments, newest first, or null.
  Field *saved();
  /// Sets all increments to 0. Owned cells may then be written through saved().
  void clear();
  /// Updates one ghost layer of all increments if owned cells may have been written.
  PetscErrorCode update_ghosts(const Box &box, GhostExchange &exchange);

private:
  Field block_;
  int newest_ = 0;  ///< index of the newest; older ones follow cyclically
  bool ghosts_valid_ = true;
};

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
