// The pressure on boundaries with a load, computed together with the flow through them (openings/outlet_loads.hpp).
#pragma once

#include "flow/projection.hpp"
#include "openings/outlet_loads.hpp"
#include "parts/flow.hpp"
#include "parts/flow_part.hpp"

namespace eulastic {

class LoadedOutlets final : public FlowPart {
public:
  LoadedOutlets(Flow *flow, Projection *projection)
      : flow_(*flow), projection_(*projection), loads_(flow->spec.sides) {}
  static bool exist(const BoundaryConditions &sides) { return !OutletLoads::none(sides); }

  std::size_t bytes() const override { return loads_.bytes(); }
  PetscErrorCode carry(CarriedState *state) override;
  PetscErrorCode start() override;
  void set_boundary_pressures(BoundaryConditions *sides) const override { *sides = loads_.with_pressures(*sides); }
  PetscErrorCode prepare(double dt) override;
  PetscErrorCode end_projection(double dt, const Field &divergence, Field &increment) override;

private:
  PetscErrorCode measure(const Field &velocity, std::vector<double> *flow) const;

  Flow &flow_;
  Projection &projection_;
  OutletLoads loads_;
};

}  // namespace eulastic
