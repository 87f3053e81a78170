// Surface tension of all phases of the grid together; docs/method.md, section 17.
#pragma once

#include "base/petsc.hpp"
#include "drops/capillary_force.hpp"
#include "field/surface_sample.hpp"
#include "field/work_space.hpp"
#include "grid/domain.hpp"

namespace eulastic {

class SurfaceTension {
public:
  static constexpr int work_fields = CapillaryForce::work_fields;  ///< of the work space, during each call

  /// `drifts`: whether no wall holds the fluid, so that any net force would move all of it for ever.
  SurfaceTension(const Domain &domain, GhostExchange &exchange, WorkSpace &work, bool drifts)
      : domain_(&domain), work_(&work), drifts_(drifts), capillary_(domain, &exchange) {}
  static bool exists(const std::vector<Phase> &phases);

  /// force += scale sigma kappa grad(phi) at owned faces; with a factor also to `slope`. Five ghosts of phi.
  /// `balanced`: less the mean over the box of what is added to `force`, in periodic directions where all drifts:
  /// surfaces exert no net force, their discretisation does.
  PetscErrorCode add_force(const std::vector<Phase> &phases, double scale, bool balanced, Field &force,
                           const WeightedTarget &slope = {});
  /// Adds energy and power.
  PetscErrorCode measure(const std::vector<Phase> &phases, const Field &velocity, SurfaceEnergy *measured);

private:
  const Domain *domain_;
  WorkSpace *work_;
  bool drifts_;
  CapillaryForce capillary_;
};

}  // namespace eulastic
