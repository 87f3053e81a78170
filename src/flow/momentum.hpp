// The right-hand side of the momentum equation (2), and the predictor (7).
#pragma once

#include "base/petsc.hpp"
#include "field/material.hpp"
#include "field/phase.hpp"
#include "parts/flow_part.hpp"
#include "solids/elastic_force.hpp"

namespace eulastic {

/// Computes dv/dt = -v.grad v + nu lap v - grad p/rho + div(sigma)/rho + f at all owned faces, including those on open
/// boundaries. Needs three ghosts of v, one of p, phi and B. `advection` holds -v.grad v of the last step (read if its
/// weight is not 0) and is replaced by that of this step; it may be an empty field if the weight is 0. The elastic
/// force is also added to `slope`.
PetscErrorCode momentum_rate(const Box &box, const Fluid &fluid, const MomentumStep &step, const Field &velocity,
                             const Field &pressure, const std::vector<Phase> &phases, Field &advection, Field &rate,
                             const WeightedTarget &slope = {});

/// Computes v* = v + dt dv/dt, (7), on owned faces. Faces on walls are not set; wall ghosts must be filled afterwards.
PetscErrorCode predict_velocity(const Box &box, const Fluid &fluid, const MomentumStep &step, const Field &velocity,
                                const Field &pressure, const std::vector<Phase> &phases, Field &velocity_star);

}  // namespace eulastic
