// Receptors on bodies in boxes: their initial positions, and their motion with the surface.
#pragma once

#include "field/phase.hpp"
#include "field/receptor.hpp"

#include <cstdint>
#include <vector>

namespace eulastic {

/// Places receptors on the surface of a body, `density` per area. Their number and positions depend only on the seed,
/// the number and the shape of the body.
void place_receptors(const BodyInBox &body, double density, std::uint32_t seed, std::vector<Receptor> *receptors);

/// Moves receptors by the midpoint rule with a velocity on the faces of a box, with one valid ghost layer behind
/// boundaries, and projects them onto the surface of the body, whose phi has been advanced already.
void move_receptors(const Box &box, double dt, const Field &velocity, const Phase &phase,
                    std::vector<Receptor> *receptors);

/// Returns the vector from a position near the surface phi = 1/2 to it along the gradient of phi, of at most a quarter
/// of a cell; 0 where phi has no gradient.
Real3 way_to_surface(const Box &box, const Phase &phase, const Real3 &place);

}  // namespace eulastic
