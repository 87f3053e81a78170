// The predictor (7) and the divergence of what it predicts.
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
/// phi and B. Faces on high walls come out unset: fill the wall ghosts. Rows are wrapped by one around a periodic x.
/// `divergence`, where given, gets D* while v* is in the caches, but on the high sides of the rank: see
/// complete_divergence().
PetscErrorCode predict_velocity(const Grid &grid, const Fluid &fluid, const MomentumStep &step,
                                const FieldBlock &velocity, const FieldBlock &pressure,
                                const std::vector<Phase> &phases, FieldBlock &velocity_star,
                                FieldBlock *divergence = nullptr);

/// Where the elastic force per mass goes beside the rate, to say how it changes in time.
struct ForceSlope {
  FieldBlock *field = nullptr;  ///< factor times that force is added; null: nowhere
  double factor = 0;
};

/// The rate dv/dt itself, for super time stepping. `advection` holds -v.grad v of the last step (read when its weight
/// is not 0) and gets that of this one; it may be empty when the weight is 0.
PetscErrorCode momentum_rate(const Grid &grid, const Fluid &fluid, const MomentumStep &step, const FieldBlock &velocity,
                             const FieldBlock &pressure, const std::vector<Phase> &phases, FieldBlock &advection,
                             FieldBlock &rate, const ForceSlope &slope = {});

/// force = scale times the elastic force of all phases, div(G phi dev B) or that of the law, 0 at owned faces that feel
/// none. One ghost of phi and B.
PetscErrorCode compute_elastic_force(const Grid &grid, double scale, const std::vector<Phase> &phases,
                                     FieldBlock &force);

/// D* = rho div v* at centres. Needs one ghost of v*. Rows are wrapped by one around a periodic x.
PetscErrorCode compute_divergence(const Grid &grid, double density, const FieldBlock &velocity_star,
                                  FieldBlock &divergence);
/// The same where predict_velocity() had no ghosts of v* yet.
PetscErrorCode complete_divergence(const Grid &grid, double density, const FieldBlock &velocity_star,
                                   FieldBlock &divergence);

}  // namespace eulastic
