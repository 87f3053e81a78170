// -v.grad q by WENO5 along rows, with one loop per direction. The loops are functions of their own, because compilers
// spill their registers to the stack when they are inlined beside other loops.
#pragma once

#include "field/field.hpp"
#include "grid/blocks.hpp"

namespace eulastic {

/// Rows that will be read or written soon. They are prefetched piece by piece, those of direction d before a loop along
/// d, because many prefetches at once wait for each other.
struct RowsAhead {
  const double *rows[3][2] = {};  ///< pointers to their first values; null: none
  int length = 0;                 ///< values per row

  /// Prefetches n values of the rows of direction d.
  [[gnu::always_inline]] void prefetch_rows(int d, int begin, int n) const noexcept {
    for (const double *row : rows[d])
      if (row) prefetch(row + begin, n);
  }
};

/// Computes rate = -v . grad v_a on a row of faces of direction a. v: face velocities with three ghosts. Here and below
/// `inverse_spacing` is 1/h of every direction, `epsilon` is 1e-6 (scale of the advected field)^2, and `rate` is
/// indexed by the cells of the row.
void face_advection_rate(const Segment &row, const Field &v, int a, const double *inverse_spacing, double epsilon,
                         const RowsAhead &ahead, double *rate);

/// Computes rate = -v . grad q on a row of centres; q has three ghosts, v one.
void centre_advection_rate(const Segment &row, ConstView q, const Field &v, const double *inverse_spacing,
                           double epsilon, const RowsAhead &ahead, double *rate);

}  // namespace eulastic
