// A force per mass on the bodies of a species alone: phi f, phi averaged to faces. Bodies keep the density of the fluid
// as far as inertia goes: settling, a centrifuge, a magnetic pull.
#pragma once

#include "base/petsc.hpp"
#include "parts/flow.hpp"
#include "parts/flow_part.hpp"

namespace eulastic {

/// Reads one ghost of phi and of the velocity.
class SpeciesForces final : public FlowPart {
public:
  explicit SpeciesForces(Flow *flow) : flow_(*flow) {}
  /// Whether any phase has one.
  static bool exist(const std::vector<Phase> &phases);
  PetscErrorCode add_rate(const MomentumRate &rate) override;
  PetscErrorCode add_power(const FlowLook &look, double *power) override;

private:
  Flow &flow_;
};

}  // namespace eulastic
