// The verbs of the explicit step with the arguments that tests vary.
#pragma once

#include "physics/momentum.hpp"

namespace eulastic::test {

/// (7) at `time`, WENO5's velocity scale 1.
inline PetscErrorCode predict(const Grid &grid, const Fluid &fluid, double time, double dt, const FieldBlock &velocity,
                              const FieldBlock &pressure, const std::vector<Phase> &phases, FieldBlock &out) {
  return predict_velocity(grid, fluid, time, dt, 1, velocity, pressure, phases, out);
}

/// (8) and (9).
inline PetscErrorCode correct(const Grid &grid, double density, double dt, const FieldBlock &increment,
                              const FieldBlock &velocity_star, FieldBlock &velocity, FieldBlock &pressure) {
  return correct_velocity(grid, density, dt, increment, velocity_star, velocity, pressure);
}

}  // namespace eulastic::test
