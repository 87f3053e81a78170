#include "drops/surface_tension.hpp"

#include "grid/threads.hpp"

#include <algorithm>

namespace eulastic {
namespace {

bool is_on_grid(const Phase &phase) { return phase.material.surface_tension > 0 && !phase.boxed; }

}  // namespace

bool SurfaceTension::exists(const std::vector<Phase> &phases) {
  return std::any_of(phases.begin(), phases.end(), is_on_grid);
}

PetscErrorCode SurfaceTension::add_force(const std::vector<Phase> &phases, double scale, bool balanced, Field &force,
                                         const WeightedTarget &slope) {
  PetscFunctionBeginUser;
  NetForce net(*domain_, balanced && drifts_);
  WorkSpace::Lease lease;
  PetscCall(work_->take("curvature", work_fields, &lease));
  for (const Phase &phase : phases) {
    if (!is_on_grid(phase)) continue;
    PetscCall(capillary_.find(phase, lease.fields()));
    capillary_.add_force(scale, force, slope, &net);
  }
  PetscCall(net.take_off(force));
  PetscFunctionReturn(0);
}

PetscErrorCode SurfaceTension::measure(const std::vector<Phase> &phases, const Field &velocity,
                                       SurfaceEnergy *measured) {
  PetscFunctionBeginUser;
  WorkSpace::Lease lease;
  PetscCall(work_->take("curvature", work_fields, &lease));
  for (const Phase &phase : phases) {
    const double sigma = phase.material.surface_tension;
    if (!is_on_grid(phase)) continue;
    PetscCall(capillary_.find(phase, lease.fields()));
    std::vector<ExactSums> parts(row_parts(*domain_), ExactSums(CapillaryForce::sums));
    capillary_.measure(velocity, 0, &parts);
    double sum[CapillaryForce::sums];
    PetscCall(reduce_parts(domain_->comm(), parts, sum));
    measured->power += sum[CapillaryForce::power] * domain_->cell_volume();
    measured->energy += sigma * sum[CapillaryForce::area];
  }
  PetscFunctionReturn(0);
}

}  // namespace eulastic
