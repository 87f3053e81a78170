#include "flow/correction.hpp"

#include "base/events.hpp"
#include "grid/row_scratch.hpp"
#include "grid/threads.hpp"
#include "kernels/momentum.hpp"

namespace eulastic {
namespace {

EULASTIC_INLINE void correct_row(int n, double factor, const double *increment, const double *below, double *v) {
#pragma omp simd
  for (int i = 0; i < n; ++i) v[i] = kernels::fma(-factor, increment[i] - below[i], v[i]);
}

EULASTIC_CLONES void correct_rows(const Box &box, const RowPart &part, double dt_over_density, double rotation,
                                  const Field &increment, const Field &divergence, Field &velocity, Field &pressure) {
  const Int3 n = box.cells();
  const ConstView q = increment[0];
  for (int k = part.k_begin; k < part.k_end; ++k)
    for (int j = part.j_begin; j < part.j_end; ++j) {
      double *p = pressure[0].row(j, k);
      const double *dp = q.row(j, k), *D = divergence[0].row(j, k);
#pragma omp simd
      for (int i = -1; i < n[0] + 1; ++i) p[i] += kernels::fma(-rotation, D[i], dp[i]);
      if (k < 0 || k >= n[2] || j < 0 || j >= n[1]) continue;
      for (int a = 0; a < box.dimension(); ++a)
        correct_row(n[0], dt_over_density / box.spacing()[a], dp, dp - q.stride(a), velocity[a].row(j, k));
    }
}

// Computes the increments below a part other than the first, before any part changes p.
EULASTIC_CLONES void find_increments_below(const Box &box, const RowPart &part, kernels::AcmIncrement formula,
                                           const Field &divergence, const Field &pressure, RowScratch &increments) {
  const int n = box.cells()[0];
  const bool flat = box.dimension() == 2;
  for (int j = flat ? part.j_begin - 1 : part.j_begin; j < (flat ? part.j_begin : part.j_end); ++j) {
    const int k = flat ? 0 : part.k_begin - 1;
    const double *D = divergence[0].row(j, k), *p = pressure[0].row(j, k);
    double *dp = increments.row(j + 1);
#pragma omp simd
    for (int i = 0; i < n; ++i) dp[i] = formula(D[i], p[i]);
  }
}

// `increments` has the rows -1 ... n_y of the plane below; each is replaced by that of this plane. The correction of u
// computes its increments again, because reading them across the vectors that were just written would stall.
EULASTIC_CLONES void correct_rows_by_formula(const Box &box, const RowPart &part, double dt_over_density,
                                             double rotation, kernels::AcmIncrement formula, const Field &divergence,
                                             Field &velocity, Field &pressure, RowScratch &increments) {
  const Int3 n = box.cells();
  const Real3 &h = box.spacing();
  const bool flat = box.dimension() == 2;
  for (int k = part.k_begin; k < part.k_end; ++k)
    for (int j = part.j_begin; j < part.j_end; ++j) {
      const double *D = divergence[0].row(j, k);
      double *p = pressure[0].row(j, k), *dp = increments.row(j + 1);
      const auto increment_at = [=](int i) EULASTIC_BODY { return formula(D[i], p[i]); };
      const auto update_pressure = [=](int i) EULASTIC_BODY {
        const double increment = increment_at(i);
        p[i] += kernels::fma(-rotation, D[i], increment);
        return increment;
      };
      const bool owned = k >= 0 && k < n[2] && j >= 0 && j < n[1];
      if (owned) {
        double *u = velocity[0].row(j, k);
        const double factor = dt_over_density / h[0];
#pragma omp simd
        for (int i = 0; i < n[0]; ++i) u[i] = kernels::fma(-factor, increment_at(i) - increment_at(i - 1), u[i]);
      }
      for (const int i : {-1, n[0]}) dp[i] = update_pressure(i);
      if (owned && !flat) {
        double *w = velocity[2].row(j, k);
        const double factor = dt_over_density / h[2];
#pragma omp simd
        for (int i = 0; i < n[0]; ++i) {
          const double increment = update_pressure(i);
          w[i] = kernels::fma(-factor, increment - dp[i], w[i]);
          dp[i] = increment;
        }
      } else {
#pragma omp simd
        for (int i = 0; i < n[0]; ++i) dp[i] = update_pressure(i);
      }
      if (owned) correct_row(n[0], dt_over_density / h[1], dp, increments.row(j), velocity[1].row(j, k));
    }
}

}  // namespace

PetscErrorCode correct_velocity(const Box &box, double density, double dt, double rotation, const Field &increment,
                                const Field &divergence, Field &velocity, Field &pressure) {
  PetscFunctionBeginUser;
  EventScope scope(Event::correction);
  in_row_parts(box, [&](const RowPart &part) {
    correct_rows(box, part.with_ghosts(box), dt / density, rotation, increment, divergence, velocity, pressure);
  });
  for (int a = 0; a < box.dimension(); ++a)
    for (const Segment &row : box.open_high_faces(a)) {
      const ConstView q = increment[0];
      const double *increment_row = q.row(row.j, row.k) + row.i_begin;
      correct_row(row.size(), dt / density / box.spacing()[a], increment_row, increment_row - q.stride(a),
                  velocity[a].row(row.j, row.k) + row.i_begin);
    }
  scope.flops(box.cell_count() * (3 * box.dimension() + 3));
  PetscFunctionReturn(0);
}

PetscErrorCode correct_velocity(const Box &box, double density, double dt, double rotation,
                                const kernels::AcmIncrement &increment, const Field &divergence, Field &velocity,
                                Field &pressure) {
  PetscFunctionBeginUser;
  EventScope scope(Event::correction);
  const int parts = row_parts(box);
  std::vector<RowScratch> increments;
  for (int part = 0; part < parts; ++part) increments.emplace_back(box, box.cells()[1] + 2);
  in_parallel(parts, parts, [&](int p) {
    const RowPart part = row_part(box, p, parts).with_ghosts(box);
    if (!part.first) find_increments_below(box, part, increment, divergence, pressure, increments[p]);
  });
  in_parallel(parts, parts, [&](int p) {
    const RowPart part = row_part(box, p, parts).with_ghosts(box);
    correct_rows_by_formula(box, part, dt / density, rotation, increment, divergence, velocity, pressure,
                            increments[p]);
  });
  scope.flops(box.cell_count() * (3 * box.dimension() + 3 + 6));
  PetscFunctionReturn(0);
}

}  // namespace eulastic
