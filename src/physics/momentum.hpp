// The predictor (7) and what surrounds the pressure: divergence and correction (9).
#pragma once

#include "field/phase.hpp"
#include "field/walls.hpp"
#include "physics/fluid.hpp"

namespace eulastic {

/// WENO5's epsilon for a field of the given scale.
inline double weno_epsilon(double scale) { return 1e-6 * scale * scale; }

/// How the advection term of this and the last step enter: 1, 0 is Euler, 1 + r/2, -r/2 Adams-Bashforth 2.
struct AdvectionWeights {
  double now = 1, before = 0;
};

/// What the momentum equation needs to know of a step.
struct MomentumStep {
  double force_time;  ///< when the body force is taken
  double dt;
  double speed_scale;  ///< typical |v|, for WENO5
  AdvectionWeights weights;
};

/// v* = v + dt/rho (-grad p + div sigma' + rho f) - dt v.grad v at all faces; (7). Needs three ghosts of v, one of p,
/// phi and B. Wall faces come out unset: fill the wall ghosts.
PetscErrorCode predict_velocity(const Grid &grid, const Fluid &fluid, const MomentumStep &step,
                                const FieldBlock &velocity, const FieldBlock &pressure,
                                const std::vector<Phase> &phases, FieldBlock &velocity_star);

/// The rate dv/dt itself, for super time stepping. `advection` holds -v.grad v of the last step (read when its weight
/// is not 0) and gets that of this one; it may be empty when the weight is 0.
PetscErrorCode momentum_rate(const Grid &grid, const Fluid &fluid, const MomentumStep &step, const FieldBlock &velocity,
                             const FieldBlock &pressure, const std::vector<Phase> &phases, FieldBlock &advection,
                             FieldBlock &rate);

/// force += scale times the elastic force of all phases, div(G phi dev B) or that of the law, at the faces that feel
/// it. One ghost of phi and B.
PetscErrorCode add_elastic_force(const Grid &grid, double scale, const std::vector<Phase> &phases, FieldBlock &force);

/// D* = rho div v* at centres. Needs one ghost of v*.
PetscErrorCode compute_divergence(const Grid &grid, double density, const FieldBlock &velocity_star,
                                  FieldBlock &divergence);

/// v* becomes v = v* - dt/rho grad(increment) (9) and p += increment - rotation D*, the latter in one ghost layer too
/// (8). rotation = nu/2 is the rotational form of the second-order step, 0 the paper's.
PetscErrorCode correct_velocity(const Grid &grid, double density, double dt, double rotation,
                                const FieldBlock &increment, const FieldBlock &divergence, FieldBlock &velocity,
                                FieldBlock &pressure);

}  // namespace eulastic
