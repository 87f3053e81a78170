// The deviatoric stress with variable viscosity on the rows of a velocity component, including rows on open boundaries.
#pragma once

#include "flow/local_viscosity.hpp"
#include "kernels/deviatoric_stress.hpp"

namespace eulastic {

/// Returns the stress around the faces of component a in a row. v needs two ghosts.
template <int Dim>
EULASTIC_INLINE kernels::DeviatoricStress<Dim> stress_on_row(const Box &box, const Field &viscosity, const Field &v,
                                                             int a, int j, int k) {
  const int b = (a + 1) % Dim, c = Dim == 3 ? (a + 2) % 3 : b;
  const auto row = [=](const Field &block, int f) { return block[f].row(j, k); };
  const ConstView q = v[0];
  const Real3 &h = box.spacing();
  return {row(v, a),
          row(v, b),
          row(v, c),
          row(viscosity, 0),
          row(viscosity, viscosity_of_edge(Dim, a, b)),
          row(viscosity, viscosity_of_edge(Dim, a, c)),
          q.stride(a),
          q.stride(b),
          q.stride(c),
          1 / h[a],
          1 / h[b],
          1 / h[c]};
}

/// Calls visit(faces, side) for the faces of component a in a row. Faces on open boundaries to which they are normal
/// are visited separately: side is -1 on a low boundary, 1 on a high one, otherwise 0.
template <class Visit>
void for_faces(const Box &box, int a, const Segment &row, const Visit &visit) {
  const auto is_open_face = [&](bool high, int at) {
    return box.is_open(a, high) && box.touches(a, high) && at == (high ? box.cells()[a] : 0);
  };
  if (a > 0) {
    const int at = a == 1 ? row.j : row.k;
    return visit(row, is_open_face(false, at) ? -1 : is_open_face(true, at) ? 1 : 0);
  }
  Segment inner = row;
  if (is_open_face(false, row.i_begin)) ++inner.i_begin;
  if (is_open_face(true, row.i_end - 1)) --inner.i_end;
  if (row.i_begin < inner.i_begin) visit(Segment{row.i_begin, inner.i_begin, row.j, row.k}, -1);
  if (inner.size() > 0) visit(inner, 0);
  if (inner.i_end < row.i_end) visit(Segment{inner.i_end, row.i_end, row.j, row.k}, 1);
}

}  // namespace eulastic
