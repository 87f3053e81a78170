// Transport of the solid: (4) for phi, (5) for B, explicit Euler with WENO5.
#pragma once

#include "base/petsc.hpp"
#include "field/phase.hpp"
#include "field/sides.hpp"

namespace eulastic {

/// The paper's: B is reset to I below one per cent. No stress there, as dev(I) = 0.
inline constexpr EvolveRule reset_below_one_per_cent{0.01, 0.01, 0.01};

/// WENO5 makes tails without end. Below this they are cut off: round-off of phi = 1, and rows without solid stay empty.
inline constexpr double negligible_fraction = 1e-16;

/// next = phi - dt v.grad phi at centres; idle rows are set to 0, where `next_rows` does not know that they are.
/// Three ghosts of both.
PetscErrorCode advect_fraction(const Box &box, double dt, const Field &velocity, const Phase &phase,
                               const OccupiedRows &next_rows, Field &next);

/// Lists where B may evolve, where it may differ from I, and which faces feel the stress. Two ghosts of
/// phi, or one more than there are layers.
PetscErrorCode find_solid(const Box &box, Phase &phase);

/// One Runge-Kutta stage of B.
struct TensorStage {
  double dt;
  bool second_of_heun;                    ///< next = (next + B + dt rate)/2, else next = B + dt rate
  const ActiveSegments *stale = nullptr;  ///< where `next` is set to I if B does not evolve there; null: everywhere
};

/// Advances B of the phase by the rate L.B + B.L^T - v.grad B where it evolves, sets I elsewhere; into `next`, which
/// holds B at the start of the step in Heun's second stage. Includes the edges on walls. Three ghosts of v and B,
/// one of phi.
PetscErrorCode transport_tensor(const Box &box, const TensorStage &stage, const Field &velocity, const Phase &phase,
                                const Field &tensor, Field &next);

/// B = I where it does not evolve, without transport, on rows that were or are occupied. One ghost of phi.
PetscErrorCode reset_exterior(const Box &box, const OccupiedRows &before, Phase &phase);

}  // namespace eulastic
