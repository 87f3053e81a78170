// The right-hand side of the momentum equation (2), and the predictor (7).
#pragma once

#include "base/petsc.hpp"
#include "field/material.hpp"
#include "field/phase.hpp"
#include "parts/flow_part.hpp"
#include "solids/elastic_force.hpp"

namespace eulastic {

/// dv/dt = -v.grad v + nu lap v - grad p/rho + div(sigma)/rho + f at all owned faces. Needs three ghosts of v, one of
/// p, phi and B. `advection` holds -v.grad v of the last step (read when its weight is not 0) and gets that of this
/// one; it may be empty when the weight is 0. Faces of open sides are owned ones.
PetscErrorCode momentum_rate(const Box &box, const Fluid &fluid, const MomentumStep &step, const Field &velocity,
                             const Field &pressure, const std::vector<Phase> &phases, Field &advection, Field &rate,
                             const WeightedTarget &slope = {});

/// v* = v + dt dv/dt, (7). Faces on walls come out unset: fill the wall ghosts. Rows are wrapped by one around a
/// periodic x.
PetscErrorCode predict_velocity(const Box &box, const Fluid &fluid, const MomentumStep &step, const Field &velocity,
                                const Field &pressure, const std::vector<Phase> &phases, Field &velocity_star);

}  // namespace eulastic
