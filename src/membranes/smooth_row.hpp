// Smoothing of phi, from which the surfaces of membranes are found; docs/method.md, section 18.
#pragma once

#include "field/field.hpp"
#include "grid/occupied_rows.hpp"

namespace eulastic {

inline constexpr int smooth_reach = 2;  ///< cells on either side

/// Averages q with the weights 1, 4, 6, 4, 1 over 16 along every direction, for begin <= i < end of a row. `across`:
/// scratch from begin - 2 to end + 2. Mirrored fields give mirrored bits.
void smooth_row(int dim, ConstView q, int j, int k, int begin, int end, double *across, double *out);

/// Whether smooth_row() reads row (j, k) for any row that is not idle.
bool is_near_occupied_row(const Box &box, const OccupiedRows &rows, int j, int k);
/// Sets `field` to 0 in the rows of is_near_occupied_row() and in all cells that are among `ghosts` layers of
/// neighbouring ranks.
void clear_near_rows(const Box &box, const OccupiedRows &rows, int ghosts, View field);

}  // namespace eulastic
