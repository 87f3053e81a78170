// The verbs of the classic step with the arguments that tests vary.
#pragma once

#include "physics/momentum.hpp"
#include "physics/transport.hpp"

namespace eulastic::test {

/// (7) at `time`, explicit Euler, WENO5's velocity scale 1.
inline PetscErrorCode predict(const Domain &grid, const Fluid &fluid, double time, double dt,
                              const FieldBlock &velocity, const FieldBlock &pressure, const std::vector<Phase> &phases,
                              FieldBlock &out) {
  return predict_velocity(grid, fluid, {time, dt, 1, {}}, velocity, pressure, phases, out);
}

/// (5), explicit Euler.
inline PetscErrorCode transport(const Domain &grid, double dt, const FieldBlock &velocity, const Phase &phase,
                                FieldBlock &next) {
  return transport_tensor(grid, {dt, false}, velocity, phase, phase.tensor.field, next);
}

}  // namespace eulastic::test
