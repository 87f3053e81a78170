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

PetscErrorCode SurfaceTension::begin_slope(double dt, Field &slope) {
  return add_force(flow_.now.phases, -1 / (dt * flow_.fluid.density), false, slope);
}

PetscErrorCode SurfaceTension::add_rate(const MomentumRate &rate) {
  return add_force(flow_.now.phases, rate.scale / flow_.fluid.density, true, rate.field, rate.slope);
}

PetscErrorCode SurfaceTension::add_force(const std::vector<Phase> &phases, double scale, bool balanced, Field &force,
                                         const WeightedTarget &slope) {
  PetscFunctionBeginUser;
  NetForce net(flow_.domain, balanced && flow_.drifts());
  WorkSpace::Lease lease;
  PetscCall(flow_.work.lease("curvature", fields, &lease));
  for (const Phase &phase : phases) {
    if (!is_on_grid(phase)) continue;
    PetscCall(capillary_.find(phase, lease.fields()));
    capillary_.add_force(scale, force, slope, &net);
  }
  PetscCall(net.subtract_mean_force(force));
  PetscFunctionReturn(0);
}

PetscErrorCode SurfaceTension::add_surface_energy(const SynchronisedBodies &bodies, SurfaceEnergy *measured,
                                                  std::vector<SurfaceSample> *) {
  const Domain &domain = flow_.domain;
  PetscFunctionBeginUser;
  WorkSpace::Lease lease;
  PetscCall(flow_.work.lease("curvature", fields, &lease));
  for (const Phase &phase : bodies.phases) {
    const double sigma = phase.material.surface_tension;
    if (!is_on_grid(phase)) continue;
    PetscCall(capillary_.find(phase, lease.fields()));
    std::vector<ExactSums> parts(row_parts(domain), ExactSums(CapillaryForce::sums));
    capillary_.measure(flow_.now.velocity, 0, &parts);
    double sum[CapillaryForce::sums];
    PetscCall(reduce_parts(domain.comm(), parts, sum));
    measured->power += sum[CapillaryForce::power] * domain.cell_volume();
    measured->energy += sigma * sum[CapillaryForce::area];
  }
  PetscFunctionReturn(0);
}

}  // namespace eulastic
