// -v.grad q by WENO5 along rows, a loop for every direction, in functions of their own: among the other loops of a verb
// compilers keep on the stack what these need in registers.
#pragma once

#include "field/field.hpp"
#include "grid/blocks.hpp"

namespace eulastic {

/// Rows that will be read or written soon. Memory is asked for them piece by piece, those of d before a loop along
/// direction d: many requests at once wait for each other.
struct RowsAhead {
  const double *rows[3][2] = {};  ///< first values; null: none
  int length = 0;                 ///< of all

  /// For n values of the rows of d.
  [[gnu::always_inline]] void prefetch_rows(int d, int begin, int n) const noexcept {
    for (const double *row : rows[d])
      if (row) prefetch(row + begin, n);
  }
};

/// rate = -v . grad v_a on a row of faces of direction a. v: the face velocities, three ghosts. Here and below
/// `inverse_spacing`: 1/h of every direction; `epsilon`: 1e-6 (scale of what is carried)^2; `rate`: by cells of the
/// row.
void face_advection_rate(const Segment &row, const Field &v, int a, const double *inverse_spacing, double epsilon,
                         const RowsAhead &ahead, double *rate);

/// rate = -v . grad q on a row of centres; q has three ghosts, v one.
void centre_advection_rate(const Segment &row, ConstView q, const Field &v, const double *inverse_spacing,
                           double epsilon, const RowsAhead &ahead, double *rate);

}  // namespace eulastic
