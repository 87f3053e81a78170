// The pressure increments of the last steps: directions that a solve begins with.
#pragma once

#include "base/petsc.hpp"
#include "field/ghost_exchange.hpp"

namespace eulastic {

class IncrementMemory {
public:
  IncrementMemory() = default;
  /// Of `count` steps; 0: none.
  IncrementMemory(const Box &box, int count);
  explicit operator bool() const { return bool(block_); }
  int count() const { return block_.count(); }
  std::size_t bytes() const { return block_.bytes(); }
  /// Of n + 1 steps ago, 0 <= n < count, or this one's after turn().
  Field increment(int n) { return block_.part((newest_ + n) % count(), 1); }
  /// The place of the oldest becomes that of the newest; until that is set its values are anything.
  void turn() { newest_ = (newest_ + count() - 1) % count(); }
  /// All, the newest first, or null.
  Field *saved();
  /// All become 0; owned cells may be written then, through saved().
  void clear();
  /// One ghost layer of all, if anybody may have written.
  PetscErrorCode update_ghosts(const Box &box, GhostExchange &exchange);

private:
  Field block_;
  int newest_ = 0;  ///< then those after it, around the block
  bool ghosts_valid_ = true;
};

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
