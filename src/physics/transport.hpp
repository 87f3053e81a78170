// Transport of the solid: (4) for phi, (5) for B, explicit Euler with WENO5.
#pragma once

#include "field/phase.hpp"
#include "field/walls.hpp"

namespace eulastic {

/// Below this solid fraction B is reset to I (the paper's rule).
inline constexpr double solid_threshold = 0.01;

/// next = phi - dt v.grad phi at centres. Three ghosts of both.
PetscErrorCode advect_fraction(const Grid &grid, double dt, const FieldBlock &velocity, const FieldBlock &fraction,
                               FieldBlock &next);

/// Lists where B may differ from I and which faces feel it. Two ghosts of phi.
PetscErrorCode find_solid(const Grid &grid, Phase &phase);

/// next = B + dt (L.B + B.L^T - v.grad B) on the phase's solid segments, I where the solid fraction there (averaged
/// to edges) is below the threshold, and elsewhere. Includes the edges on walls. Three ghosts of v and B, one of phi.
PetscErrorCode transport_tensor(const Grid &grid, double dt, const FieldBlock &velocity, const Phase &phase,
                                FieldBlock &next);

/// B = I below the threshold, without transport. One ghost of phi.
PetscErrorCode reset_exterior(const Grid &grid, Phase &phase);

}  // namespace eulastic
