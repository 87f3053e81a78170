// What a pressure sweep does with rows: the sums that say how far to go, and the step.
#pragma once

#include "base/exact_sum.hpp"
#include "base/petsc.hpp"
#include "grid/domain.hpp"
#include "pressure/increment_memory.hpp"

#include <functional>

namespace eulastic {

/// D and the directions that it is minimised over: q_f, whose Laplacians L_f are taken, and, if `recurs`, the step d
/// before, of which L is the D before less D. One ghost layer of the q_f is read.
struct SweepTask {
  const Domain *domain;
  const ConstView *q;
  int stencils;  ///< how many q_f: 1 to SweepSums::most, 1 if `recurs`
  bool recurs;
  ConstView residual, before;

  int directions() const { return stencils + recurs; }
};

/// Exact sums of a sweep, of rows in any order, as soon as somebody has them at hand.
class RowSums {
public:
  void start(const Domain &domain, int directions);
  /// Adds rows j_begin <= j < j_end of plane k (3-D) but those at the ends of y and z, by this thread.
  void add_inner(const SweepTask &task, int thread, int j_begin, int j_end, int k);
  /// Adds all rows that are not yet in and finds the coefficients and the mean of q_0. Collective. What D before - D
  /// has of rounding must not count: a step that moved D by less than a millionth gets the coefficient 0.
  PetscErrorCode find_minimum(const SweepTask &task, SweepMinimum *minimum, double *mean);

private:
  std::vector<ExactSums> sums_;  ///< by threads
  std::vector<char> summed_;     ///< owned rows that are in them
};

/// What a sweep does to the increment. Every second one leaves its d to the next, which still has it.
enum class Increment { later, set, set_two, add, add_two };

/// d = sum c_i q_i + c d - shift, in place, and increment += scale d, both in one ghost layer too; new D = D - sum c_i
/// L_i, owned; for `after` wrapped around a periodic x by one. New D may be where `before` is.
struct StepTask : SweepTask {
  const double *coefficient;
  double shift, scale;
  Increment how;
  bool last;  ///< leaves D and d alone
  View new_residual, direction, increment;
  /// In 3-D: after(thread, j_begin, j_end, k) for rows around which all owned ones have been done. May be null.
  std::function<void(int, int, int, int)> after;
};
void take_step(const StepTask &task);

}  // namespace eulastic
