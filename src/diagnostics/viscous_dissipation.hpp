// What viscosity takes where bodies have their own.
#pragma once

#include "flow/local_viscosity.hpp"

namespace eulastic {

/// tau : grad v per mass of the cells of a row, into out[0 .. cells): normal stress at the centre, shear on the cell's
/// low edges. Edges on a side count half, those on the high side with the last cell, and where two sides meet nothing
/// moves: summed up, the power of the walls less that of add_viscous_force().
void viscous_dissipation(const Box &box, const Field &viscosity, const Field &velocity, const Segment &row,
                         double *out);

}  // namespace eulastic
