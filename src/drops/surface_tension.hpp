// Surface tension of all phases on the grid; docs/method.md, section 17.
#pragma once

#include "base/petsc.hpp"
#include "drops/capillary_force.hpp"
#include "parts/flow.hpp"
#include "parts/flow_part.hpp"

namespace eulastic {

class SurfaceTension final : public FlowPart {
public:
  explicit SurfaceTension(Flow *flow) : flow_(*flow), capillary_(flow->domain, &flow->exchange) {}
  /// Whether any phase on the grid has surface tension.
  static bool exists(const std::vector<Phase> &phases);
  static constexpr int fields = CapillaryForce::work_fields;  ///< components of the work space that each call uses
  PetscErrorCode begin_slope(double dt, Field &slope) override;
  PetscErrorCode add_rate(const MomentumRate &rate) override;
  PetscErrorCode add_surface_energy(const SynchronisedBodies &bodies, SurfaceEnergy *measured,
                                    std::vector<SurfaceSample> *samples) override;

  /// force += scale sigma kappa grad(phi) at owned faces; the force, times its factor, is also added to `slope`. Reads
  /// five ghosts of phi. `balanced`: subtracts the mean over the box of what is added to `force`, if no wall resists
  /// the flow. A closed surface exerts no net force, but its discretisation does.
  PetscErrorCode add_force(const std::vector<Phase> &phases, double scale, bool balanced, Field &force,
                           const WeightedTarget &slope = {});

private:
  Flow &flow_;
  CapillaryForce capillary_;
};

}  // namespace eulastic
