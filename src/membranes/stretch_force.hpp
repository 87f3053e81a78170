// -NAME_stretch_force on the labelled bodies of a grid: both ends of a body are pulled apart along x, as optical
// tweezers do; docs/method.md, (27a).
#pragma once

#include "base/petsc.hpp"
#include "bodies/body_owners.hpp"
#include "field/ghost_exchange.hpp"
#include "field/net_force.hpp"
#include "field/phase.hpp"
#include "grid/domain.hpp"

namespace eulastic {

class StretchForces {
public:
  /// Whether bodies of any phase on the grid are pulled.
  static bool exist(const std::vector<Phase> &phases);

  /// Finds the ends of the bodies that are here; `owners` stays, `references`: BodyTracker::connect. Exact sums, one
  /// per cell along x and body. Collective.
  PetscErrorCode find(const Domain &domain, const std::vector<Phase> &phases, const BodyOwners &owners,
                      const std::vector<Int3> &references);
  /// Adds the force per volume at owned faces, to each target as many times as it says. `scratch`: a field.
  PetscErrorCode add(GhostExchange &exchange, const std::vector<Phase> &phases, Field &scratch,
                     const std::vector<WeightedTarget> &targets) const;
  /// What they do on the flow; one ghost of the velocity. Collective.
  PetscErrorCode power(const std::vector<Phase> &phases, const Field &velocity, double *power) const;

private:
  template <class Visit>
  void for_cells(const std::vector<Phase> &phases, const Visit &visit) const;

  const Domain *domain_ = nullptr;
  const BodyOwners *owners_ = nullptr;
  std::vector<Int3> near_;                 ///< references of bodies that are here
  std::vector<std::vector<double>> pull_;  ///< of these, by column of cells across x: force per volume
};

}  // namespace eulastic
