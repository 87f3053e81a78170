// Sums that have the same bits for any order, number of ranks or threads, and vector length (docs/method.md, section
// 10).
//
// A row is added in blocks of 256 cells by absolute x index, each in eight fixed lanes (i mod 8) and a fixed tree. The
// block sums enter a fixed-point superaccumulator (cf. Kulisch) of 67 limbs of 32 bits, which cover 2^-1074 to 2^1024.
// All sums of a routine share one Allreduce. A block that is not finite makes its sum NaN.
#pragma once

#include "base/petsc.hpp"

#include <array>
#include <cstdint>
#include <vector>

namespace eulastic {

/// One exact sum of doubles, for up to 2^31 additions.
class Superaccumulator {
public:
  static constexpr int limbs = 67;
  static constexpr int words = limbs + 1;  ///< the last word counts terms that are not finite

  void add(double value) noexcept;
  /// Adds values[0..n), n <= buffer_size. The sum has the same bits as with single additions, and is much faster if the
  /// exponents are similar.
  static constexpr int buffer_size = 64;
  void add(const double *values, int n) noexcept;
  /// Adds the sum of `other`.
  void add(const Superaccumulator &other) noexcept;
  /// Returns the correctly rounded sum, or NaN if any term was not finite.
  double value() const noexcept;

private:
  std::array<std::int64_t, words> word_{};
};

/// Returns the sum of values[0..n), at most one block, in eight lanes. The first value has the absolute index `first`.
double lane_sum(const double *values, int n, std::int64_t first) noexcept;

/// A set of `count` exact sums over all ranks.
class ExactSums {
public:
  static constexpr int block = 256;
  /// Number of cells before absolute x index x in its block. x may be negative.
  static int index_in_block(std::int64_t x) noexcept { return static_cast<int>(x & (block - 1)); }

  explicit ExactSums(int count) : sums_(count), buffers_(count) {}
  void clear() noexcept;
  void add(int s, double value) noexcept {
    Buffer &w = buffers_[s];
    w.value[w.count++] = value;
    if (w.count == Superaccumulator::buffer_size) flush(s);
  }
  /// Adds values[0..n), a piece of a row that starts at absolute x index `first`. The bits are reproducible only if all
  /// values of a block that one rank owns are added in one call.
  void add_row(int s, const double *values, int n, std::int64_t first) noexcept;
  /// Adds the sums of `other`, which has the same number of sums, and flushes its buffers.
  void add(ExactSums &other) noexcept;
  /// Sums over all ranks with one Allreduce, writes `count` doubles to `result` and resets all sums to zero.
  PetscErrorCode reduce(MPI_Comm comm, double *result);

private:
  struct Buffer {
    double value[Superaccumulator::buffer_size];
    int count = 0;
  };
  void flush(int s) noexcept;

  std::vector<Superaccumulator> sums_;
  std::vector<Buffer> buffers_;
};

/// Adds the sums of all parts over all ranks, writes them to `result` and resets `parts[0]`. All parts have the same
/// number of sums. Collective.
PetscErrorCode reduce_parts(MPI_Comm comm, std::vector<ExactSums> &parts, double *result);
/// Returns in result[n] the largest parts[...][n] over all parts and ranks. All parts have the same length; NaN is
/// ignored. Collective.
PetscErrorCode reduce_maxima(MPI_Comm comm, const std::vector<std::vector<double>> &parts, std::vector<double> *result);

}  // namespace eulastic
