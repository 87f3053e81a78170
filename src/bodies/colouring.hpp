// Few colours for bodies of which no near two may share one.
#pragma once

#include "bodies/near_bodies.hpp"

namespace eulastic {

/// A colour, 0 and up, of each of `bodies`, labels in ascending order; `pairs` are of them. The body whose neighbours
/// have the most colours is next and takes the lowest that is free (DSATUR: Brelaz, Comm. ACM 22 (1979) 251); of equals
/// the one with the most neighbours, then the lowest label.
std::vector<int> colour_bodies(const std::vector<int> &bodies, const std::vector<NearBodies> &pairs);

}  // namespace eulastic
