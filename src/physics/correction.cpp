#include "physics/correction.hpp"

#include "base/events.hpp"
#include "physics/row_scratch.hpp"

#include <algorithm>

namespace eulastic {
namespace {

EULASTIC_INLINE void correct_row(const Grid &grid, double factor, const double *increment, const double *below,
                                 double *v) {
#pragma omp simd
  for (int i = 0; i < grid.owned()[0]; ++i) v[i] = kernels::fma(-factor, increment[i] - below[i], v[i]);
  if (grid.wraps_x()) grid.wrap_row(v, Grid::stencil_width);
}

EULASTIC_CLONES void correct_rows(const Grid &grid, double dt_over_density, double rotation,
                                  const FieldBlock &increment, const FieldBlock &divergence, FieldBlock &velocity,
                                  FieldBlock &pressure) {
  const Int3 n = grid.owned();
  const int gz = grid.dimension() == 3 ? 1 : 0;
  const ConstView q = increment[0];
  for (int k = -gz; k < n[2] + gz; ++k)
    for (int j = -1; j < n[1] + 1; ++j) {
      double *p = pressure[0].row(j, k);
      const double *dp = q.row(j, k), *D = divergence[0].row(j, k);
#pragma omp simd
      for (int i = -1; i < n[0] + 1; ++i) p[i] += kernels::fma(-rotation, D[i], dp[i]);
      if (k < 0 || k >= n[2] || j < 0 || j >= n[1]) continue;
      for (int a = 0; a < grid.dimension(); ++a)
        correct_row(grid, dt_over_density / grid.spacing()[a], dp, dp - q.stride(a), velocity[a].row(j, k));
    }
}

// `increments`: rows -1 ... n_y of the plane below, each until it is that of this plane, and one more.
EULASTIC_CLONES void correct_rows_by_formula(const Grid &grid, double dt_over_density, double rotation,
                                             kernels::AcmIncrement formula, const FieldBlock &divergence,
                                             FieldBlock &velocity, FieldBlock &pressure, RowScratch &increments) {
  const Int3 n = grid.owned();
  const int gz = grid.dimension() == 3 ? 1 : 0;
  for (int k = -gz; k < n[2] + gz; ++k)
    for (int j = -1; j < n[1] + 1; ++j) {
      const double *D = divergence[0].row(j, k);
      double *p = pressure[0].row(j, k), *dp = increments.row(n[1] + 2), *below = increments.row(j + 1);
#pragma omp simd
      for (int i = -1; i < n[0] + 1; ++i) {
        dp[i] = formula(D[i], p[i]);
        p[i] += kernels::fma(-rotation, D[i], dp[i]);
      }
      if (k >= 0 && k < n[2] && j >= 0 && j < n[1]) {
        const double *neighbour[3] = {dp - 1, increments.row(j), below};
        for (int a = 0; a < grid.dimension(); ++a)
          correct_row(grid, dt_over_density / grid.spacing()[a], dp, neighbour[a], velocity[a].row(j, k));
      }
      std::copy(dp - 1, dp + n[0] + 1, below - 1);
    }
}

}  // namespace

PetscErrorCode correct_velocity(const Grid &grid, double density, double dt, double rotation,
                                const FieldBlock &increment, const FieldBlock &divergence, FieldBlock &velocity,
                                FieldBlock &pressure) {
  PetscFunctionBeginUser;
  VerbScope scope(Verb::correction);
  correct_rows(grid, dt / density, rotation, increment, divergence, velocity, pressure);
  scope.flops(grid.owned_count() * (3 * grid.dimension() + 3));
  PetscFunctionReturn(0);
}

PetscErrorCode correct_velocity(const Grid &grid, double density, double dt, double rotation,
                                const kernels::AcmIncrement &increment, const FieldBlock &divergence,
                                FieldBlock &velocity, FieldBlock &pressure) {
  PetscFunctionBeginUser;
  VerbScope scope(Verb::correction);
  RowScratch increments(grid, grid.owned()[1] + 3);
  correct_rows_by_formula(grid, dt / density, rotation, increment, divergence, velocity, pressure, increments);
  scope.flops(grid.owned_count() * (3 * grid.dimension() + 3 + 6));
  PetscFunctionReturn(0);
}

}  // namespace eulastic
