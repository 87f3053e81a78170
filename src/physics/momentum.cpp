#include "physics/momentum.hpp"

#include "base/events.hpp"
#include "grid/blocks.hpp"
#include "grid/row_scratch.hpp"
#include "kernels/momentum.hpp"
#include "kernels/mooney_rivlin.hpp"
#include "kernels/weno5.hpp"
#include "physics/advection.hpp"

#include <algorithm>
#include <cmath>

namespace eulastic {
namespace {

struct PredictorTerms {
  const Grid *grid;
  const FieldBlock *velocity, *pressure;
  const std::vector<Phase> *phases;
  bool inertia;
  double dt, density, kinematic_viscosity, epsilon;
  AdvectionWeights weights;
  FieldBlock *advection;   // null: not kept
  FieldBlock *divergence;  // of v*; null: not wanted
  bool rate_only;          // write dv/dt instead of v + dt dv/dt
  ForceSlope slope;
  Real3 force, inverse, inverse_squared;
};

// force += scale div(sigma), the law's stress, on the stressed segments of rows j_begin <= j < j_end of plane k; times
// `factor` also to `slope`, where it is given.
template <int Dim, bool WithSlope>
EULASTIC_INLINE void add_elastic_force(const Grid &grid, const std::vector<Phase> &phases, double scale, int j_begin,
                                       int j_end, int k, FieldBlock &force, const ForceSlope &slope) {
  // Block position of a tensor component, see tensor_components().
  const auto at = [](int x, int y) { return x == y ? x : Dim == 2 ? 2 : 6 - x - y; };
  for (const Phase &phase : phases) {
    const Material &material = phase.material;
    if (!material.elastic()) continue;
    const FieldBlock &B = phase.tensor;
    const ConstView phi = phase.fraction[0];
    const kernels::MooneyRivlin law{scale * 2 * material.c1, scale * 2 * material.c2, scale * 4 * material.c3};
    const auto add = [&](kernels::Batch &batch) EULASTIC_BODY {
      for (int a = 0; a < Dim; ++a) {
        const int b = (a + 1) % Dim, c = Dim == 3 ? (a + 2) % 3 : b;
        if (Dim == 3) {  // two planes on
          batch.ahead[0] = B[at(a, a)].origin + 2 * phi.sz;
          batch.ahead[1] = B[at(a, b)].origin + 2 * phi.sz;
        }
        const kernels::TensorViews views{B[at(a, a)], B[at(b, b)], B[at(c, c)], B[at(a, b)], B[at(a, c)]};
        const std::ptrdiff_t stride[3] = {phi.stride(a), phi.stride(b), phi.stride(c)};
        const Real3 &h = grid.spacing();
        const double inverse[3] = {1 / h[a], 1 / h[b], 1 / h[c]};
        double *sum = force[a].origin, *change = WithSlope ? (*slope.field)[a].origin : nullptr;
        const double factor = slope.factor;
        const auto add_to = [=](std::ptrdiff_t o, double f) EULASTIC_BODY {
          sum[o] += f;
          if (WithSlope) change[o] = kernels::fma(factor, f, change[o]);
        };
        if (material.law == Law::neo_hookean)
          kernels::elastic_force<Dim>(batch, phi, views, stride, inverse, scale * material.shear_modulus, add_to);
        else
          kernels::mooney_rivlin_force<Dim>(batch, phi, views, B[at(b, c)], stride, inverse, law, add_to);
      }
    };
    if (phase.stressed.idle_rows(j_begin, j_end, k)) continue;
    kernels::Batch batch;
    for (int j = j_begin; j < j_end; ++j)
      for (const Segment &s : phase.stressed.row(j, k)) {
        if (Dim == 3) {                                            // what is beside the vectors there, and phi
          const int i = s.i_begin - 1, length = s.size() + 2 + 7;  // up to its last cache line
          prefetch(phi.row(j, k + 2) + i, length);
          for (int f = 0; f < B.count(); ++f) {
            const double *row = B[f].row(j, k + 2);
            prefetch(row + i, 1);
            prefetch(row + s.i_end, 1);
          }
          for (const int y : {j - 1, j + 1}) {
            if (!phase.stressed.idle(y, k)) continue;
            prefetch(phi.row(y, k + 2) + i, length);
            for (int f = 0; f < B.count(); ++f) prefetch(B[f].row(y, k + 2) + i, length);
          }
        }
        kernels::gather(batch, j * phi.sy + k * phi.sz, s.i_begin, std::min(s.i_end, grid.owned()[0]), add);
      }
    add(batch);
  }
}

// rate holds -v.grad v of now and `kept` that of the last step; they trade places, weighted.
EULASTIC_INLINE void combine_advection(int n, AdvectionWeights weights, double *kept, double *rate) {
#pragma omp simd
  for (int i = 0; i < n; ++i) {
    const double now = rate[i], before = kept[i];
    rate[i] = kernels::fma(weights.now, now, weights.before * before);
    kept[i] = now;
  }
}

// No flow through the low walls, before the divergence is taken.
template <int Dim>
EULASTIC_INLINE void close_low_faces(const Grid &grid, int begin, int end, int k, FieldBlock &v) {
  const int n = grid.owned()[0];
  for (int j = begin; j < end; ++j) {
    if (grid.touches_low(0)) v[0](0, j, k) = 0;
    if (grid.touches_low(1) && j == 0) std::fill_n(v[1].row(j, k), n, 0.0);
    if (Dim == 3 && grid.touches_low(2) && k == 0) std::fill_n(v[2].row(j, k), n, 0.0);
  }
}

// Rows begin <= j < end of plane k, from cell `first` on.
template <int Dim>
EULASTIC_INLINE void divergence_rows(const Grid &grid, double density, const FieldBlock &v, int first, int begin,
                                     int end, int k, FieldBlock &out) {
  const Real3 inverse{1 / grid.spacing()[0], 1 / grid.spacing()[1], 1 / grid.spacing()[2]};
  for (int j = begin; j < end; ++j) {
    double *row = out[0].row(j, k);
    kernels::divergence<Dim>({first, grid.owned()[0], j, k}, v[0], v[1], v[Dim - 1], inverse.data(), density, row);
    if (grid.wraps_x()) grid.wrap_row(row, 1);
  }
}

// Fewer rows than for other verbs, as nine fields share the cache.
constexpr int rows_of_block = block_rows / 2;

template <int Dim, bool RateOnly>
EULASTIC_INLINE void predict(const PredictorTerms &t, const RowPart &part, FieldBlock &out, RowScratch &scratch) {
  const FieldBlock &v = *t.velocity;
  const ConstView p = (*t.pressure)[0];
  const Int3 n = t.grid->owned();
  double *rate = scratch.row(0);
  for (int block = part.j_begin; block < part.j_end; block += rows_of_block)
    for (int k = part.k_begin; k < part.k_end; ++k) {
      const int end = std::min(block + rows_of_block, part.j_end);
      for (int j = block; j < end; ++j) {
        const Segment row{0, n[0], j, k};
        for (int a = 0; a < Dim; ++a) {
          RowsAhead ahead;
          if (Dim == 3) {  // rows of the stencil, at the block's sides too, and of the result
            constexpr int reach = Grid::stencil_width;
            const RowAhead next(block, end, j, k);
            const auto at = [&](ConstView q, int y, int z) { return q.row(next.j + y, next.k + z) - reach; };
            const int side = next.j < block + reach ? -reach : next.j >= end - reach ? reach : 0;
            ahead.length = n[0] + 2 * reach + 7;  // up to the last cache line
            ahead.rows[0][0] = at(v[a], 0, reach);
            if (side != 0) ahead.rows[0][1] = at(v[a], side, 0);
            ahead.rows[1][0] = at(out[a], 0, 0);
            if (a == 1) ahead.rows[1][1] = at(p, 0, 0);
            if (a == 2 && t.divergence) ahead.rows[2][0] = at((*t.divergence)[0], 0, -1);
            if (t.advection) ahead.rows[2][1] = at((*t.advection)[a], 0, 0);
          }
          if (t.inertia) {
            face_advection_rate(row, v, a, t.inverse.data(), t.epsilon, ahead, rate);
            if (t.advection) combine_advection(n[0], t.weights, (*t.advection)[a].row(j, k), rate);
          } else {
            for (int d = 0; d < Dim; ++d) ahead.ask(d, 0, ahead.length);
            std::fill_n(rate, n[0], 0.0);
          }
          kernels::add_viscous_pressure_force<Dim, RateOnly>(row, v[a], t.kinematic_viscosity, t.inverse_squared.data(),
                                                             p, p.stride(a), t.inverse[a] / t.density, t.force[a], rate,
                                                             t.dt, out[a].row(j, k));
        }
      }
      if (RateOnly && t.slope.field)
        add_elastic_force<Dim, true>(*t.grid, *t.phases, 1 / t.density, block, end, k, out, t.slope);
      else
        add_elastic_force<Dim, false>(*t.grid, *t.phases, (RateOnly ? 1 : t.dt) / t.density, block, end, k, out, {});
      if (RateOnly) continue;
      close_low_faces<Dim>(*t.grid, block, end, k, out);
      if (t.grid->wraps_x())
        for (int a = 0; a < Dim; ++a)
          for (int j = block; j < end; ++j) t.grid->wrap_row(out[a].row(j, k), 1);
      const int before = Dim == 3 ? k - 1 : k;  // where the faces above are known, but for the last row's
      if (t.divergence && before >= part.k_begin)
        divergence_rows<Dim>(*t.grid, t.density, out, 0, std::max(block - 1, part.j_begin), end - 1, before,
                             *t.divergence);
    }
}

EULASTIC_CLONES void predict_2d(const PredictorTerms &t, const RowPart &part, FieldBlock &out, RowScratch &s) {
  t.rate_only ? predict<2, true>(t, part, out, s) : predict<2, false>(t, part, out, s);
}
EULASTIC_CLONES void predict_3d(const PredictorTerms &t, const RowPart &part, FieldBlock &out, RowScratch &s) {
  t.rate_only ? predict<3, true>(t, part, out, s) : predict<3, false>(t, part, out, s);
}

template <int Dim>
EULASTIC_INLINE void elastic_rows(const Grid &grid, const RowPart &part, double scale, const std::vector<Phase> &phases,
                                  FieldBlock &force) {
  for_rows_in_blocks(
      part,
      [&](int j, int k) EULASTIC_BODY {
        for (int a = 0; a < Dim; ++a) {
          if (Dim == 3) prefetch(force[a].row(j, k + 1), grid.owned()[0]);
          std::fill_n(force[a].row(j, k), grid.owned()[0], 0.0);
        }
      },
      [&](int begin, int end, int k)
          EULASTIC_BODY { add_elastic_force<Dim, false>(grid, phases, scale, begin, end, k, force, {}); });
}

EULASTIC_CLONES void elastic_2d(const Grid &g, const RowPart &part, double scale, const std::vector<Phase> &phases,
                                FieldBlock &force) {
  elastic_rows<2>(g, part, scale, phases, force);
}
EULASTIC_CLONES void elastic_3d(const Grid &g, const RowPart &part, double scale, const std::vector<Phase> &phases,
                                FieldBlock &force) {
  elastic_rows<3>(g, part, scale, phases, force);
}

// Flops per component of the velocity.
double elastic_flops(int dimension, const std::vector<Phase> &phases) {
  double sum = 0;
  for (const Phase &phase : phases) {
    const bool flat = dimension == 2, neo_hookean = phase.material.law == Law::neo_hookean;
    const double per_face = neo_hookean ? (flat ? kernels::elastic_flops_2d : kernels::elastic_flops_3d)
                                        : (flat ? kernels::mooney_rivlin_flops_2d : kernels::mooney_rivlin_flops_3d);
    sum += phase.stressed.points() * per_face;
  }
  return sum;
}

// All rows, or those that predict() leaves.
template <int Dim>
EULASTIC_INLINE void divergence_everywhere(const Grid &grid, const RowPart &part, double density, const FieldBlock &v,
                                           bool left_only, FieldBlock &out) {
  const Int3 n = grid.owned();
  for (int k = part.k_begin; k < part.k_end; ++k) {
    const int inner = left_only && (Dim == 2 || k < part.k_end - 1) ? part.j_end - 1 : part.j_begin;
    if (!grid.wraps_x()) divergence_rows<Dim>(grid, density, v, n[0] - 1, part.j_begin, inner, k, out);
    divergence_rows<Dim>(grid, density, v, 0, inner, part.j_end, k, out);
  }
}

EULASTIC_CLONES void divergence_2d(const Grid &g, const RowPart &part, double density, const FieldBlock &v,
                                   bool left_only, FieldBlock &out) {
  divergence_everywhere<2>(g, part, density, v, left_only, out);
}
EULASTIC_CLONES void divergence_3d(const Grid &g, const RowPart &part, double density, const FieldBlock &v,
                                   bool left_only, FieldBlock &out) {
  divergence_everywhere<3>(g, part, density, v, left_only, out);
}

void run_divergence(const Grid &grid, double density, const FieldBlock &v, bool left_only, FieldBlock &out) {
  in_row_parts(grid, [&](const RowPart &part) {
    (grid.dimension() == 2 ? divergence_2d : divergence_3d)(grid, part, density, v, left_only, out);
  });
}

double divergence_flops(int dimension) { return 3 * dimension - 1; }

// Cells of which predict() knows all faces.
double inner_count(const Grid &grid) {
  const Int3 n = grid.owned();
  const int x = n[0] - (grid.wraps_x() ? 0 : 1), parts = row_parts(grid);
  return grid.dimension() == 3 ? double(x) * (n[1] - 1) * (n[2] - parts) : double(x) * (n[1] - parts);
}

void run_predictor(const Grid &grid, const Fluid &fluid, const MomentumStep &step, const FieldBlock &velocity,
                   const FieldBlock &pressure, const std::vector<Phase> &phases, FieldBlock *advection,
                   FieldBlock *divergence, bool rate_only, const ForceSlope &slope, FieldBlock &out) {
  VerbScope scope(Verb::momentum);
  const int dim = grid.dimension();
  const Real3 &h = grid.spacing();
  const PredictorTerms terms{&grid,
                             &velocity,
                             &pressure,
                             &phases,
                             fluid.inertia,
                             step.dt,
                             fluid.density,
                             fluid.kinematic_viscosity(),
                             weno_epsilon(step.speed_scale),
                             step.weights,
                             advection,
                             divergence,
                             rate_only,
                             slope,
                             fluid.body_force.at(step.force_time),
                             {1 / h[0], 1 / h[1], 1 / h[2]},
                             {1 / h[0] * (1 / h[0]), 1 / h[1] * (1 / h[1]), 1 / h[2] * (1 / h[2])}};
  in_row_parts(grid, [&](const RowPart &part) {
    RowScratch scratch(grid, 1);
    (dim == 2 ? predict_2d : predict_3d)(terms, part, out, scratch);
  });
  const double per_face = (fluid.inertia ? dim * (kernels::weno5_flops + 3) + 4 * (dim - 1) : 0) +
                          dim * kernels::viscous_pressure_flops_per_direction + 5;
  scope.flops(dim * (grid.owned_count() * per_face + elastic_flops(dim, phases)));
  if (slope.field)
    for (const Phase &phase : phases) scope.flops(dim * 2 * phase.stressed.points());
  if (divergence) scope.flops(inner_count(grid) * divergence_flops(dim));
}

}  // namespace

PetscErrorCode predict_velocity(const Grid &grid, const Fluid &fluid, const MomentumStep &step,
                                const FieldBlock &velocity, const FieldBlock &pressure,
                                const std::vector<Phase> &phases, FieldBlock &velocity_star, FieldBlock *divergence) {
  PetscFunctionBeginUser;
  run_predictor(grid, fluid, step, velocity, pressure, phases, nullptr, divergence, false, {}, velocity_star);
  PetscFunctionReturn(0);
}

PetscErrorCode momentum_rate(const Grid &grid, const Fluid &fluid, const MomentumStep &step, const FieldBlock &velocity,
                             const FieldBlock &pressure, const std::vector<Phase> &phases, FieldBlock &advection,
                             FieldBlock &rate, const ForceSlope &slope) {
  PetscFunctionBeginUser;
  run_predictor(grid, fluid, step, velocity, pressure, phases, advection ? &advection : nullptr, nullptr, true, slope,
                rate);
  PetscFunctionReturn(0);
}

PetscErrorCode compute_elastic_force(const Grid &grid, double scale, const std::vector<Phase> &phases,
                                     FieldBlock &force) {
  PetscFunctionBeginUser;
  VerbScope scope(Verb::momentum);
  const bool flat = grid.dimension() == 2;
  in_row_parts(grid, [&](const RowPart &part) { (flat ? elastic_2d : elastic_3d)(grid, part, scale, phases, force); });
  scope.flops(grid.dimension() * elastic_flops(grid.dimension(), phases));
  PetscFunctionReturn(0);
}

PetscErrorCode compute_divergence(const Grid &grid, double density, const FieldBlock &velocity_star,
                                  FieldBlock &divergence) {
  PetscFunctionBeginUser;
  VerbScope scope(Verb::divergence);
  run_divergence(grid, density, velocity_star, false, divergence);
  scope.flops(grid.owned_count() * divergence_flops(grid.dimension()));
  PetscFunctionReturn(0);
}

PetscErrorCode complete_divergence(const Grid &grid, double density, const FieldBlock &velocity_star,
                                   FieldBlock &divergence) {
  PetscFunctionBeginUser;
  VerbScope scope(Verb::divergence);
  run_divergence(grid, density, velocity_star, true, divergence);
  scope.flops((grid.owned_count() - inner_count(grid)) * divergence_flops(grid.dimension()));
  PetscFunctionReturn(0);
}

}  // namespace eulastic
