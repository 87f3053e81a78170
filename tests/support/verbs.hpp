// The verbs of the classic step with the arguments that tests vary.
#pragma once

#include "flow/momentum.hpp"
#include "solids/transport.hpp"

namespace eulastic::test {

/// (7) at `time`, explicit Euler, WENO5's velocity scale 1.
inline PetscErrorCode predict(const Domain &domain, const Fluid &fluid, double time, double dt, const Field &velocity,
                              const Field &pressure, const std::vector<Phase> &phases, Field &out) {
  return predict_velocity(domain, fluid, {time, dt, 1, {}}, velocity, pressure, phases, out);
}

/// (5), explicit Euler.
inline PetscErrorCode transport(const Domain &domain, double dt, const Field &velocity, const Phase &phase,
                                Field &next) {
  return transport_tensor(domain, {dt, false}, velocity, phase, phase.tensor.field, next);
}

}  // namespace eulastic::test
