// Faces of the grid inside rigid bodies, from their shapes alone, before any field exists (rigid/rigid_bodies.hpp).
#pragma once

#include "bodies/volume_fraction.hpp"
#include "scene/config.hpp"

#include <string>

namespace eulastic {

inline constexpr unsigned centre_inside = 8;

/// Returns for a global, unwrapped cell of the body the bits 1 << a of the directions along which the low face of the
/// cell is inside the body, and centre_inside.
unsigned faces_inside(const PlacedBody &body, const DomainShape &grid, const Int3 &cell);

/// Returns one line on a rigid sphere, ellipsoid, biconcave disc or cylinder that contains no face of the grid at
/// t = 0, so that a run would not notice it; or nothing. Every rank knows all rigid bodies.
std::string check_small_bodies(const Config &config);

}  // namespace eulastic
