// The net force of surfaces, which is zero except for discretisation errors. Without walls the error would accelerate
// the whole fluid, so that the mean is subtracted (docs/method.md, section 17).
#pragma once

#include "base/exact_sum.hpp"
#include "base/petsc.hpp"
#include "base/team.hpp"
#include "field/field.hpp"
#include "grid/domain.hpp"

namespace eulastic {

/// Adds n values to a row of a force, and `factor` times these values to its change in time unless `slope` is null.
void add_force_row(int n, const double *added, double factor, double *force, double *slope);

/// Subtracts `mean` from the force on all owned faces.
void subtract_mean(const Box &box, const Real3 &mean, Field &force);

/// The exact sum over all faces of the contributions to a force, with the same bits on any number of ranks.
class NetForce {
public:
  /// If not `wanted`, all functions do nothing.
  NetForce(const Domain &domain, bool wanted);
  /// Adds a row of contributions to component d on the faces of a block; called by part `part` of row_parts(box) or by
  /// a member of a team.
  void add_row(const Box &box, int part, int d, const double *added) {
    if (!sums_.empty()) sums_[TeamMember::number() + part].add_row(d, added, box.cells()[0], box.layout().begin[0]);
  }
  /// Returns the mean force in periodic directions, 0 in the others. Collective.
  PetscErrorCode compute_mean(Real3 *mean);
  /// Subtracts the mean from the force. Collective.
  PetscErrorCode subtract_mean_force(Field &force);

private:
  const Domain *domain_;
  std::vector<ExactSums> sums_;
};

}  // namespace eulastic
