// One step of `-method fast`: bodies are half a step behind the velocity, and a step is of second order in time;
// docs/method.md, sections 2 to 8 and 16.
#pragma once

#include "flow/implicit_viscosity.hpp"
#include "solver/scheme.hpp"

namespace eulastic {

class FastStep final : public Scheme {
public:
  using Scheme::Scheme;
  PetscErrorCode start() override;
  std::size_t bytes() const override { return Scheme::bytes() + implicit_.bytes(); }
  PetscErrorCode step(double dt, const Look &in_middle, const Look &with_pressure) override;

private:
  PetscErrorCode begin_slope(double dt);
  void extrapolate_pressure(double dt);
  PetscErrorCode predict(double dt);
  PetscErrorCode advance_viscous_stages(const Fluid &fluid, const MomentumStep &step, const WeightedTarget &slope);
  PressureRotation rotation() const;

  ImplicitViscosity implicit_;  ///< where viscosities differ, unless there are rigid bodies; else empty
};

}  // namespace eulastic
