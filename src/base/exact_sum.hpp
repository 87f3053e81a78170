// Sums that do not depend on order, ranks, threads or vector length.
//
// A row is added in blocks of 256 cells by absolute x index, each with eight fixed lanes (i mod 8) and a fixed
// tree; the block sums enter a fixed-point superaccumulator (67 limbs of 32 bits cover 2^-1074 ... 2^1024; cf.
// Kulisch). All sums of a verb share one Allreduce. A non-finite block makes its sum NaN.
#pragma once

#include "base/petsc.hpp"

#include <array>
#include <cstdint>
#include <vector>

namespace eulastic {

/// One exact sum of doubles. Good for 2^31 additions.
class Superaccumulator {
public:
  static constexpr int limbs = 67;
  static constexpr int words = limbs + 1;  ///< the last one counts non-finite terms

  void add(double value) noexcept;
  /// Adds values[0..n), n <= several: the same sum as one by one, and much sooner if their exponents are
  /// alike.
  static constexpr int several = 64;
  void add(const double *values, int n) noexcept;
  /// Adds what the other one has.
  void add(const Superaccumulator &other) noexcept;
  /// The correctly rounded sum of everything added, NaN if any term was not finite.
  double value() const noexcept;

private:
  std::array<std::int64_t, words> word_{};
};

/// Eight-lane sum of values[0..n), at most one block, the first value having absolute index `first`.
double lane_sum(const double *values, int n, std::int64_t first) noexcept;

/// `count` exact sums over all ranks.
class ExactSums {
public:
  static constexpr int block = 256;
  /// How many cells of its block come before the one with this absolute x index, which may be negative.
  static int place_in_block(std::int64_t x) noexcept { return static_cast<int>(x & (block - 1)); }

  explicit ExactSums(int count) : sums_(count), waiting_(count) {}
  void clear() noexcept;
  void add(int s, double value) noexcept {
    Waiting &w = waiting_[s];
    w.value[w.count++] = value;
    if (w.count == Superaccumulator::several) flush(s);
  }
  /// Adds values[0..n), a piece of a row that starts at absolute x index `first`. Pieces of one block on one rank
  /// must be added together (a whole block or all of the row) for the same bits.
  void add_row(int s, const double *values, int n, std::int64_t first) noexcept;
  /// Adds the sums of `other`, of as many.
  void add(ExactSums &other) noexcept;
  /// Sums over all ranks with one Allreduce, returns `count` doubles and starts again from zero.
  PetscErrorCode reduce(MPI_Comm comm, double *result);

private:
  struct Waiting {
    double value[Superaccumulator::several];
    int count = 0;
  };
  void flush(int s) noexcept;

  std::vector<Superaccumulator> sums_;
  std::vector<Waiting> waiting_;
};

/// The sums of all parts over all ranks. Collective; `parts` start again from zero.
PetscErrorCode reduce_parts(MPI_Comm comm, std::vector<ExactSums> &parts, double *result);
/// The largest of every number of all parts, as many in each, over all ranks. Drops NaN. Collective.
PetscErrorCode reduce_maxima(MPI_Comm comm, const std::vector<std::vector<double>> &parts, std::vector<double> *result);

}  // namespace eulastic
