// Segments with every point of a box.
#pragma once

#include "field/field.hpp"
#include "grid/active_segments.hpp"

#include <utility>

namespace eulastic {

inline void build_all(const Box &box, ActiveSegments *segments) {
  const Field zero(box, 1);
  segments->build(box, zero[0], OccupiedRows(), 0.0, 0, 0);
}

}  // namespace eulastic
