// One step of `-method fast`: bodies are half a step behind the velocity, and a step is of second order in time;
// docs/method.md, sections 2 to 8 and 16.
#pragma once

#include "solver/scheme.hpp"

#include <memory>

namespace eulastic {

class ImplicitViscosity;

class FastStep final : public Scheme {
public:
  FastStep(Flow *flow, Projection *projection);
  ~FastStep() override;
  PetscErrorCode start() override;
  std::size_t bytes() const override;
  PetscErrorCode step(double dt, const Observer &in_middle, const Observer &with_pressure) override;

private:
  PetscErrorCode begin_slope(double dt);
  void extrapolate_pressure(double dt);
  PetscErrorCode predict(double dt);
  PetscErrorCode advance_viscous_stages(const Fluid &fluid, const MomentumStep &step, const WeightedTarget &slope);
  RotationalUpdate rotation() const;

  std::unique_ptr<ImplicitViscosity> implicit_;  ///< where viscosities differ and there are no rigid bodies; else null
};

}  // namespace eulastic
