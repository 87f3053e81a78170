// What viscosity takes where bodies have their own, and the viscosity that edges on walls see.
#pragma once

#include "physics/viscosity.hpp"

namespace eulastic {

/// Dynamic viscosity on edges: one for all, or where bodies have their own that of the place.
struct EdgeViscosity {
  const Grid &grid;
  double uniform;  ///< dynamic
  double density;
  const FieldBlock *local;  ///< kinematic, of compute_viscosity(); null: uniform

  /// On the low edge of a cell normal to the directions a and b.
  double at(int a, int b, const Int3 &cell) const {
    if (!local) return uniform;
    return density * (*local)[viscosity_of_edge(grid.dimension(), a, b)](cell[0], cell[1], cell[2]);
  }
};

/// tau : grad v per mass of the cells of a row, into out[0 .. cells): normal stress at the centre, shear on the cell's
/// low edges. Edges on a side count half, those on the high side with the last cell, and where two sides meet nothing
/// moves: summed up, the power of the walls less that of add_viscous_force().
void viscous_dissipation(const Grid &grid, const FieldBlock &viscosity, const FieldBlock &velocity, const Segment &row,
                         double *out);

}  // namespace eulastic
