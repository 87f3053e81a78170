// Viscous dissipation if bodies have their own viscosity.
#pragma once

#include "flow/local_viscosity.hpp"

namespace eulastic {

/// Writes tau : grad v per mass of the cells of a row to out[0 .. cells): normal stress at the centre, shear on the
/// cell's low edges. Edges on a boundary count half, and those on a high boundary belong to the last cell; an edge on
/// two boundaries does not move. The sum is the power of the walls less that of add_viscous_force(), (30).
void viscous_dissipation(const Box &box, const Field &viscosity, const Field &velocity, const Segment &row,
                         double *out);

}  // namespace eulastic
