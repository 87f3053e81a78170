// Transport of solids: (4) for phi and (5) for B, explicit Euler with WENO5.
#pragma once

#include "base/petsc.hpp"
#include "field/boundaries.hpp"
#include "field/phase.hpp"

namespace eulastic {

/// Rule of the paper: B is reset to I where phi < 0.01. There is no stress there, because dev(I) = 0.
inline constexpr EvolveRule reset_below_one_per_cent{0.01, 0.01, 0.01};

/// WENO5 leaves tails of phi everywhere. Values below this bound, the round-off of phi = 1, are set to 0, so that rows
/// without solid stay empty.
inline constexpr double negligible_fraction = 1e-16;

/// next = phi - dt v.grad phi at centres, and 0 in idle rows, except for those in which it already is 0 by `next_rows`.
/// Reads three ghosts of phi and v.
PetscErrorCode advect_fraction(const Box &box, double dt, const Field &velocity, const Phase &phase,
                               const OccupiedRows &next_rows, Field &next);

/// Finds where B may evolve, where it may differ from I, and which faces the stress reaches. Reads two ghosts of phi,
/// or one more than there are layers.
PetscErrorCode find_solid(const Box &box, Phase &phase);

/// One Runge-Kutta stage of B.
struct TensorStage {
  double dt;
  bool second_of_heun;                    ///< next = (next + B + dt rate)/2, else next = B + dt rate
  const ActiveSegments *stale = nullptr;  ///< where `next` is reset to I if B does not evolve; null: everywhere
};

/// Advances B of the phase by the rate L.B + B.L^T - v.grad B where it evolves and sets I elsewhere. In Heun's second
/// stage `next` must hold B at the start of the step. Edges on walls are included. Reads three ghosts of v and B and
/// one of phi.
PetscErrorCode transport_tensor(const Box &box, const TensorStage &stage, const Field &velocity, const Phase &phase,
                                const Field &tensor, Field &next);

/// Sets B = I where it does not evolve, on rows that were or are occupied. Reads one ghost of phi.
PetscErrorCode reset_exterior(const Box &box, const OccupiedRows &before, Phase &phase);

}  // namespace eulastic
