#include "flow/momentum.hpp"

#include "base/events.hpp"
#include "field/advection.hpp"
#include "grid/blocks.hpp"
#include "grid/row_scratch.hpp"
#include "kernels/momentum.hpp"
#include "kernels/weno5.hpp"

#include <algorithm>

namespace eulastic {
namespace {

struct RateTerms {
  const Box &box;
  const Field &velocity, &pressure;
  const std::vector<Phase> &phases;
  Field *advection;  // null: not stored
  WeightedTarget slope;
  bool inertia;
  double density, epsilon;
  AdvectionWeights weights;
  Real3 body_force, inverse;  // inverse: of the spacing
  InverseSquares viscosity;   // nu/h^2
};

RateTerms rate_terms(const Box &box, const Fluid &fluid, const MomentumStep &step, const Field &velocity,
                     const Field &pressure, const std::vector<Phase> &phases) {
  const Real3 &h = box.spacing(), inverse{1 / h[0], 1 / h[1], 1 / h[2]};
  const double nu = fluid.kinematic_viscosity();
  const auto over_square = [&](int d) { return nu * (inverse[d] * inverse[d]); };
  return {box,
          velocity,
          pressure,
          phases,
          nullptr,
          {},
          fluid.inertia,
          fluid.density,
          weno_epsilon(step.speed_scale),
          step.weights,
          fluid.body_force.at(step.force_time),
          inverse,
          {over_square(0), over_square(1), over_square(2)}};
}

// The rows of a block in one plane.
struct BlockRows {
  int begin, end, k;
};

// Returns the rows to prefetch before row j of component a: rows of its stencil, also at the ends of the block, of the
// result and of the other fields.
RowsAhead rows_ahead(const RateTerms &t, const BlockRows &block, int a, int j, const Field &out) {
  constexpr int reach = Box::stencil_width;
  const RowAhead next(block.begin, block.end, j, block.k);
  const auto at = [&](ConstView q, int y, int z) { return q.row(next.j + y, next.k + z) - reach; };
  const int side = next.j < block.begin + reach ? -reach : next.j >= block.end - reach ? reach : 0;
  RowsAhead ahead;
  ahead.length = t.box.cells()[0] + 2 * reach + 7;  // up to the last cache line
  ahead.rows[0][0] = at(t.velocity[a], 0, reach);
  if (side != 0) ahead.rows[0][1] = at(t.velocity[a], side, 0);
  ahead.rows[1][0] = at(out[a], 0, 0);
  if (a == 1) ahead.rows[1][1] = at(t.pressure[0], 0, 0);
  if (t.advection) ahead.rows[2][1] = at((*t.advection)[a], 0, 0);
  return ahead;
}

// On entry `rate` holds -v.grad v of this step and `kept` that of the last one; on return `rate` holds their weighted
// sum and `kept` that of this step.
EULASTIC_INLINE void combine_advection(const Segment &row, AdvectionWeights weights, double *kept, double *rate) {
#pragma omp simd
  for (int i = row.i_begin; i < row.i_end; ++i) {
    const double now = rate[i], before = kept[i];
    rate[i] = kernels::fma(weights.now, now, weights.before * before);
    kept[i] = now;
  }
}

// Computes all terms except the elastic force for component a on a row. `advection` is a row of scratch.
template <int Dim>
EULASTIC_INLINE void rate_of_row(const RateTerms &t, const Segment &row, int a, const RowsAhead &ahead,
                                 double *advection, Field &out) {
  const Field &v = t.velocity;
  const ConstView p = t.pressure[0];
  if (t.inertia) {
    face_advection_rate(row, v, a, t.inverse.data(), t.epsilon, ahead, advection);
    if (t.advection) combine_advection(row, t.weights, (*t.advection)[a].row(row.j, row.k), advection);
  } else {
    for (int d = 0; d < Dim; ++d) ahead.prefetch_rows(d, 0, ahead.length);
    std::fill(advection + row.i_begin, advection + row.i_end, 0.0);
  }
  kernels::fluid_rate<Dim>(row, advection, v[a], t.viscosity, p, p.stride(a), t.inverse[a] / t.density, t.body_force[a],
                           out[a].row(row.j, row.k));
}

template <int Dim>
EULASTIC_INLINE void fluid_rate(const RateTerms &t, const BlockRows &block, double *advection, Field &out) {
  const int n = t.box.cells()[0];
  for (int j = block.begin; j < block.end; ++j) {
    const Segment row{0, n, j, block.k};
    for (int a = 0; a < Dim; ++a) {
      const RowsAhead ahead = Dim == 3 ? rows_ahead(t, block, a, j, out) : RowsAhead{};
      rate_of_row<Dim>(t, row, a, ahead, advection, out);
    }
  }
}

EULASTIC_CLONES void fluid_rate_2d(const RateTerms &t, const BlockRows &block, double *advection, Field &out) {
  fluid_rate<2>(t, block, advection, out);
}
EULASTIC_CLONES void fluid_rate_3d(const RateTerms &t, const BlockRows &block, double *advection, Field &out) {
  fluid_rate<3>(t, block, advection, out);
}

// The same on the high faces of open boundaries, which are not part of the rows.
EULASTIC_CLONES void open_face_rate_2d(const RateTerms &t, const Segment &row, int a, double *advection, Field &out) {
  rate_of_row<2>(t, row, a, {}, advection, out);
}
EULASTIC_CLONES void open_face_rate_3d(const RateTerms &t, const Segment &row, int a, double *advection, Field &out) {
  rate_of_row<3>(t, row, a, {}, advection, out);
}

// Half as many rows as in other routines, because nine fields share the cache.
constexpr int rows_of_block = block_rows / 2;

// Computes the rate, and calls after(rows) while these rows are in the caches.
template <class After>
void compute_rate(const RateTerms &t, Field &out, const After &after) {
  EventScope scope(Event::momentum);
  const int dim = t.box.dimension();
  in_row_parts(t.box, [&](const RowPart &part) {
    RowScratch scratch(t.box, 1);
    for (int begin = part.j_begin; begin < part.j_end; begin += rows_of_block)
      for (int k = part.k_begin; k < part.k_end; ++k) {
        const BlockRows block{begin, std::min(begin + rows_of_block, part.j_end), k};
        (dim == 2 ? fluid_rate_2d : fluid_rate_3d)(t, block, scratch.row(0), out);
        add_elastic_force(t.box, t.phases, 1 / t.density, block.begin, block.end, k, out, t.slope);
        after(block);
      }
  });
  for (int a = 0; a < dim; ++a)
    for (const Segment &row : t.box.open_high_faces(a)) {
      const RowScratch scratch(t.box, 1);
      (dim == 2 ? open_face_rate_2d : open_face_rate_3d)(t, row, a, scratch.row(0), out);
      add_elastic_force(t.box, t.phases, 1 / t.density, row, a, out, t.slope);
    }
  const double per_face = (t.inertia ? dim * (kernels::weno5_flops + 3) + 4 * (dim - 1) : 0) +
                          dim * kernels::viscous_pressure_flops_per_direction + 5;
  scope.flops(dim * t.box.cell_count() * per_face + elastic_flops(dim, t.phases));
  if (t.slope.field)
    for (const Phase &phase : t.phases) scope.flops(dim * 2 * phase.tensor.stressed.points());
}

// Replaces the rate by v + dt rate.
EULASTIC_CLONES void advance_row(const Segment &row, double dt, ConstView velocity, View rate) {
  const double *v = velocity.row(row.j, row.k);
  double *out = rate.row(row.j, row.k);
#pragma omp simd
  for (int i = row.i_begin; i < row.i_end; ++i) out[i] = kernels::fma(dt, out[i], v[i]);
}
void advance_by_rate(const Box &box, const BlockRows &block, double dt, const Field &velocity, Field &rate) {
  for (int a = 0; a < box.dimension(); ++a)
    for (int j = block.begin; j < block.end; ++j)
      advance_row({0, box.cells()[0], j, block.k}, dt, velocity[a], rate[a]);
}

}  // namespace

PetscErrorCode momentum_rate(const Box &box, const Fluid &fluid, const MomentumStep &step, const Field &velocity,
                             const Field &pressure, const std::vector<Phase> &phases, Field &advection, Field &rate,
                             const WeightedTarget &slope) {
  PetscFunctionBeginUser;
  RateTerms terms = rate_terms(box, fluid, step, velocity, pressure, phases);
  terms.advection = advection ? &advection : nullptr;
  terms.slope = slope;
  compute_rate(terms, rate, [](const BlockRows &) {});
  PetscFunctionReturn(0);
}

PetscErrorCode predict_velocity(const Box &box, const Fluid &fluid, const MomentumStep &step, const Field &velocity,
                                const Field &pressure, const std::vector<Phase> &phases, Field &velocity_star) {
  PetscFunctionBeginUser;
  compute_rate(rate_terms(box, fluid, step, velocity, pressure, phases), velocity_star,
               [&](const BlockRows &block) { advance_by_rate(box, block, step.dt, velocity, velocity_star); });
  for (int a = 0; a < box.dimension(); ++a)
    for (const Segment &row : box.open_high_faces(a)) advance_row(row, step.dt, velocity[a], velocity_star[a]);
  PetscFunctionReturn(0);
}

}  // namespace eulastic
