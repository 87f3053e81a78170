// A force per mass on the bodies of one species: phi f, with phi averaged to faces. It models sedimentation,
// centrifuges or magnets. The inertia of the bodies remains that of the fluid's density.
#pragma once

#include "base/petsc.hpp"
#include "parts/flow.hpp"
#include "parts/flow_part.hpp"

namespace eulastic {

/// Reads one ghost of phi and of the velocity.
class SpeciesForces final : public FlowPart {
public:
  explicit SpeciesForces(Flow *flow) : flow_(*flow) {}
  /// Whether any phase has a body force.
  static bool exist(const std::vector<Phase> &phases);
  PetscErrorCode add_rate(const MomentumRate &rate) override;
  PetscErrorCode add_power(const SynchronisedBodies &bodies, double *power) override;

private:
  Flow &flow_;
};

}  // namespace eulastic
