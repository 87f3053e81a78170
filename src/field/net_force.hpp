// Forces of surfaces add up to nothing; their discretisation does within its error, and where no wall holds the fluid
// that would move all of it for ever. docs/method.md, section 17.
#pragma once

#include "base/exact_sum.hpp"
#include "base/petsc.hpp"
#include "base/team.hpp"
#include "field/field.hpp"
#include "grid/domain.hpp"

namespace eulastic {

/// n values to a force, and `factor` times them to its change in time, where there is one.
void add_force_row(int n, const double *added, double factor, double *force, double *slope);

/// force -= mean on all owned faces.
void take_off_mean(const Box &box, const Real3 &mean, Field &force);

/// The sum over all faces of what is added to a force. Exact: the same bits on any ranks.
class NetForce {
public:
  /// Not `wanted`: does nothing.
  NetForce(const Domain &domain, bool wanted);
  /// Row of component d that part `part` of row_parts(box), or a member of a team, has added on the faces of a block.
  void add_row(const Box &box, int part, int d, const double *added) {
    if (!sums_.empty()) sums_[TeamMember::number() + part].add_row(d, added, box.cells()[0], box.layout().begin[0]);
  }
  /// Its mean in periodic directions, 0 in others. Collective.
  PetscErrorCode find_mean(Real3 *mean);
  /// Takes it off. Collective.
  PetscErrorCode take_off(Field &force);

private:
  const Domain *domain_;
  std::vector<ExactSums> sums_;
};

}  // namespace eulastic
