// Ghosts behind one side of the box as an image of what is before it; for the files of this room.
#pragma once

#include "field/field.hpp"
#include "grid/occupied_rows.hpp"

namespace eulastic {

/// The plane 0 of direction d, ghosts of the other directions included.
struct Plane {
  Int3 begin{}, end{};
  Plane(const Layout &layout, int d) {
    for (int e = 0; e < 3; ++e) {
      begin[e] = e == d ? 0 : -layout.ghosts[e];
      end[e] = e == d ? 1 : layout.cells[e] + layout.ghosts[e];
    }
  }
};

/// One side of one direction: q(ghost m) = twice_wall + sign q(mirror image), m = 1 ... width, or as far as there is
/// memory behind a neighbour's wall. Runs over all ghosts of the other directions, so that doing the directions in turn
/// fills edges and corners.
struct Reflection {
  double sign, twice_wall;
  bool about_face = false;  ///< of a staggered field: twice what is on the face in place of twice_wall
};

void reflect(const Box &box, View q, int d, bool high, bool staggered, Reflection rule, int width,
             const OccupiedRows *rows = nullptr);

}  // namespace eulastic
