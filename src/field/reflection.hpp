// Fills the ghosts behind one boundary by reflection; used by the boundary conditions of this folder.
#pragma once

#include "field/field.hpp"
#include "grid/occupied_rows.hpp"

namespace eulastic {

/// The plane 0 of direction d, including ghosts of the other directions.
struct Plane {
  Int3 begin{}, end{};
  Plane(const Layout &layout, int d) {
    for (int e = 0; e < 3; ++e) {
      begin[e] = e == d ? 0 : -layout.ghosts[e];
      end[e] = e == d ? 1 : layout.cells[e] + layout.ghosts[e];
    }
  }
};

/// The rule of a reflection: q(ghost m) = twice_wall + sign q(mirror image), m = 1 ... width, or as far as there is
/// memory behind a boundary that another rank touches. It is applied to all ghosts of the other directions, so that
/// edges and corners are filled when all directions are processed in turn.
struct Reflection {
  double sign, twice_wall;
  bool about_face = false;  ///< for a staggered field: the value on the face replaces half of twice_wall
};

/// Applies `rule` to field q behind the low or high boundary of direction d. Rows that `rows` marks as idle are
/// skipped.
void reflect(const Box &box, View q, int d, bool high, bool staggered, Reflection rule, int width,
             const OccupiedRows *rows = nullptr);

}  // namespace eulastic
