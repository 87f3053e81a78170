// The smoothed solid fraction that surfaces of membranes are found from; docs/method.md, section 18.
#pragma once

#include "field/field.hpp"
#include "grid/occupied_rows.hpp"

namespace eulastic {

inline constexpr int smooth_reach = 2;  ///< cells to either side

/// The mean of q with the weights 1, 4, 6, 4, 1 over 16 along every direction, for begin <= i < end of a row. `across`:
/// scratch, from begin - 2 to end + 2. Mirrored rows give the mirrored bits.
void smooth_row(int dim, ConstView q, int j, int k, int begin, int end, double *across, double *out);

/// 0 where smooth_row() reads around rows that are not idle, and, where neighbours may ask for `ghosts` of this rank's
/// values, in what they get.
/// cleared_around(): whether a row is one of the former.
bool cleared_around(const Box &box, const OccupiedRows &rows, int j, int k);
void clear_around(const Box &box, const OccupiedRows &rows, int ghosts, View field);

}  // namespace eulastic
