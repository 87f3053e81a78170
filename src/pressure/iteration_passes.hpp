// Passes over rows of a pressure iteration: the sums that determine the coefficients, and the update of the fields.
#pragma once

#include "base/exact_sum.hpp"
#include "base/petsc.hpp"
#include "grid/domain.hpp"
#include "pressure/increment_memory.hpp"

#include <functional>

namespace eulastic {

/// D and the directions over which it is minimised: q_f, whose Laplacians L_f are computed, and, if `with_previous`,
/// the previous step d, whose L is the previous D less D. Reads one ghost layer of the q_f.
struct IterationTask {
  const Domain *domain;
  const ConstView *q;
  int stencils;  ///< number of q_f: 1 to LeastSquaresSums::most, 1 if `with_previous`
  bool with_previous;
  ConstView residual, before;

  int directions() const { return stencils + with_previous; }
};

/// Exact sums of an iteration. Rows may be added in any order, as soon as they are available.
class IterationSums {
public:
  void start(const Domain &domain, int directions);
  /// Adds rows j_begin <= j < j_end of plane k (3-D), except for those at the ends of y and z, by this thread.
  void add_inner(const IterationTask &task, int thread, int j_begin, int j_end, int k);
  /// Adds all remaining rows and computes the coefficients and the mean of q_0. A previous step that changed D by less
  /// than a millionth gets the coefficient 0, because its L is mainly round-off. Collective.
  PetscErrorCode find_minimum(const IterationTask &task, LeastSquaresSolution *minimum, double *mean);

private:
  std::vector<ExactSums> sums_;  ///< of each thread
  std::vector<char> summed_;     ///< whether an owned row has been added
};

/// Change of the increment by an iteration. Every second iteration (`later`) leaves its d to the next one, which adds
/// both.
enum class Increment { later, set, set_two, add, add_two };

/// Updates d = sum c_i q_i + c d - shift in place and increment += scale d, both including one ghost layer, and
/// computes the new D = D - sum c_i L_i of owned cells, wrapped around a periodic x by one cell for `after`. The new D
/// may be stored in `before`.
struct UpdateTask : IterationTask {
  const double *coefficient;
  double shift, scale;
  Increment how;
  bool last;  ///< D and d are not updated
  View new_residual, direction, increment;
  /// In 3-D: called as after(thread, j_begin, j_end, k) for rows around which all owned rows are complete. May be null.
  std::function<void(int, int, int, int)> after;
};
void update_fields(const UpdateTask &task);

}  // namespace eulastic
