// The predictor (7) and what surrounds the pressure: divergence and correction (9).
#pragma once

#include "field/phase.hpp"
#include "field/walls.hpp"
#include "physics/fluid.hpp"

namespace eulastic {

/// WENO5's epsilon for a field of the given scale.
inline double weno_epsilon(double scale) { return 1e-6 * scale * scale; }

/// v* = v + dt/rho (-grad p + div sigma' + rho f) - dt v.grad v at all faces; (7). Needs three ghosts of v, one of p,
/// phi and B. `speed_scale`: typical |v|, for WENO5. Wall faces come out unset: fill the wall ghosts.
PetscErrorCode predict_velocity(const Grid &grid, const Fluid &fluid, double time, double dt, double speed_scale,
                                const FieldBlock &velocity, const FieldBlock &pressure,
                                const std::vector<Phase> &phases, FieldBlock &velocity_star);

/// D* = rho div v* at centres. Needs one ghost of v*.
PetscErrorCode compute_divergence(const Grid &grid, double density, const FieldBlock &velocity_star,
                                  FieldBlock &divergence);

/// v = v* - dt/rho grad(increment) (9) and p += increment, the latter in one ghost layer too (8).
PetscErrorCode correct_velocity(const Grid &grid, double density, double dt, const FieldBlock &increment,
                                const FieldBlock &velocity_star, FieldBlock &velocity, FieldBlock &pressure);

}  // namespace eulastic
