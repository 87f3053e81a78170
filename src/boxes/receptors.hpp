// Receptors on the bodies in boxes: where they are at the start, and how they move with the surface.
#pragma once

#include "field/phase.hpp"
#include "field/receptor.hpp"

#include <cstdint>
#include <vector>

namespace eulastic {

/// Places receptors on the surface of a body, `density` per area. How many an area gets and where depends on seed,
/// number and shape of the body alone.
void place_receptors(const BodyInBox &body, double density, std::uint32_t seed, std::vector<Receptor> *receptors);

/// Moves receptors by the midpoint rule with a velocity on the faces of a box, one ghost behind sides valid, and back
/// to the surface of the body, whose phi has been moved already.
void move_receptors(const Box &box, double dt, const Field &velocity, const Phase &phase,
                    std::vector<Receptor> *receptors);

/// The way from a place near the surface phi = 1/2 to it, along the gradient of phi, at most a quarter of a cell; 0
/// where phi has no gradient.
Real3 way_to_surface(const Box &box, const Phase &phase, const Real3 &place);

}  // namespace eulastic
