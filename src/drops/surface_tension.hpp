// Surface tension of all phases of the grid together; docs/method.md, section 17.
#pragma once

#include "base/petsc.hpp"
#include "drops/capillary_force.hpp"
#include "parts/flow.hpp"
#include "parts/flow_part.hpp"

namespace eulastic {

class SurfaceTension final : public FlowPart {
public:
  explicit SurfaceTension(Flow *flow) : flow_(*flow), capillary_(flow->domain, &flow->exchange) {}
  static bool exists(const std::vector<Phase> &phases);
  static constexpr int fields = CapillaryForce::work_fields;  ///< of the work space, during each call
  PetscErrorCode begin_slope(double dt, Field &slope) override;
  PetscErrorCode add_rate(const MomentumRate &rate) override;
  PetscErrorCode add_surface_energy(const FlowLook &look, SurfaceEnergy *measured,
                                    std::vector<SurfaceSample> *samples) override;

  /// force += scale sigma kappa grad(phi) at owned faces; with a factor also to `slope`. Five ghosts of phi.
  /// `balanced`: less the mean over the box of what is added to `force`, in periodic directions where all drifts:
  /// surfaces exert no net force, their discretisation does.
  PetscErrorCode add_force(const std::vector<Phase> &phases, double scale, bool balanced, Field &force,
                           const WeightedTarget &slope = {});

private:
  Flow &flow_;
  CapillaryForce capillary_;
};

}  // namespace eulastic
