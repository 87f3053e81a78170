// Transport of the solid fraction by WENO5, and the segments of solid points.
#include "base/events.hpp"
#include "field/advection.hpp"
#include "grid/blocks.hpp"
#include "grid/box.hpp"
#include "grid/row_scratch.hpp"
#include "kernels/stencils.hpp"
#include "kernels/weno5.hpp"
#include "solids/transport.hpp"

#include <algorithm>

namespace eulastic {
namespace {

constexpr double epsilon = 1e-6;  // WENO5: phi is of order 1

struct AdvectionTerms {
  const Box *box;
  double dt;
  const Field *velocity;
  Real3 inverse;
};

template <int Dim>
EULASTIC_INLINE void advect_rows(const AdvectionTerms &t, const RowPart &part, const Phase &phase,
                                 const OccupiedRows &next_rows, Field &out, RowScratch &scratch) {
  const Int3 n = t.box->cells();
  const ConstView phi = phase.fraction[0];
  const double dt = t.dt;
  const int ghosts = t.box->layout().ghosts[0];
  const Field &v = *t.velocity;
  double *rate = scratch.row(0);
  for_rows_in_blocks(part, [&](int j, int k) EULASTIC_BODY {
    const OccupiedRows::Span span = phase.rows.span(j, k), old = next_rows.span(j, k);
    const int begin = std::max(old.begin, -ghosts), end = std::min(old.end, n[0] + ghosts);
    double *next = out[0].row(j, k);
    for (int i = begin; i < std::min(end, span.begin); ++i) next[i] = 0;
    for (int i = std::max(begin, span.end); i < end; ++i) next[i] = 0;
    const Segment row{std::max(span.begin, 0) & -8, std::min((span.end + 7) & -8, n[0]), j, k};  // whole vectors
    if (row.size() <= 0) return;
    RowsAhead ahead;
    if (Dim == 3) {  // the next plane
      const auto at = [&](ConstView q, int plane) { return q.row(j, k + plane) + row.i_begin; };
      ahead = {{{at(phi, 4), nullptr}, {at(v[0], 2), at(v[1], 2)}, {at(v[2], 2), at(out[0], 1)}}, row.size()};
    }
    centre_advection_rate(row, phi, v, t.inverse.data(), epsilon, ahead, rate);
    const double *now = phi.row(j, k);
#pragma omp simd
    for (int i = row.i_begin; i < row.i_end; ++i) {
      const double moved = kernels::fma(dt, rate[i], now[i]);
      next[i] = __builtin_fabs(moved) < negligible_fraction ? 0 : moved;
    }
  });
}

EULASTIC_CLONES void advect_2d(const AdvectionTerms &t, const RowPart &part, const Phase &phase,
                               const OccupiedRows &next_rows, Field &out, RowScratch &s) {
  advect_rows<2>(t, part, phase, next_rows, out, s);
}
EULASTIC_CLONES void advect_3d(const AdvectionTerms &t, const RowPart &part, const Phase &phase,
                               const OccupiedRows &next_rows, Field &out, RowScratch &s) {
  advect_rows<3>(t, part, phase, next_rows, out, s);
}

}  // namespace

PetscErrorCode advect_fraction(const Box &box, double dt, const Field &velocity, const Phase &phase,
                               const OccupiedRows &next_rows, Field &next) {
  PetscFunctionBeginUser;
  EventScope scope(Event::solid_fraction);
  const Real3 &h = box.spacing();
  const AdvectionTerms terms{&box, dt, &velocity, {1 / h[0], 1 / h[1], 1 / h[2]}};
  in_row_parts(box, [&](const RowPart &part) {
    RowScratch scratch(box, 1);
    (box.dimension() == 2 ? advect_2d : advect_3d)(terms, part, phase, next_rows, next, scratch);
  });
  scope.flops(double(phase.rows.cells()) * (box.dimension() * (kernels::weno5_flops + 5) + 2));
  PetscFunctionReturn(0);
}

PetscErrorCode find_solid(const Box &box, Phase &phase) {
  PetscFunctionBeginUser;
  EventScope scope(Event::solid_fraction);
  const ConstView phi = phase.fraction[0];
  const EvolveRule &rule = phase.tensor.rule;
  phase.tensor.evolving.build(box, phi, phase.rows, rule.centre, 1, 0);
  if (rule.layers > 0)
    phase.tensor.strained.build(box, phi, phase.rows, rule.centre, rule.layers + 1, rule.layers);
  else
    phase.tensor.strained = phase.tensor.evolving;
  phase.tensor.stressed.build(box, phi, phase.rows, rule.stressed, rule.reach, rule.reach);
  PetscFunctionReturn(0);
}

}  // namespace eulastic
