#include "pressure/acm.hpp"

#include "base/events.hpp"
#include "field/exact_sum.hpp"
#include "kernels/momentum.hpp"

#include <cmath>
#include <vector>

namespace eulastic {
namespace {

constexpr int sum_count = 6;  // A1, A2, A3, B1, B2 of (13) and <p> of (6)

struct SumRows {
  double *product[sum_count];
};

template <int Dim>
EULASTIC_INLINE void products(const Segment &s, ConstView divergence, ConstView pressure, const double *second,
                              const SumRows &rows) {
  const double *D = divergence.row(s.j, s.k), *p = pressure.row(s.j, s.k);
  const std::ptrdiff_t sy = divergence.sy, sz = divergence.sz;
#pragma omp simd
  for (int i = s.i_begin; i < s.i_end; ++i) {
    const double lap_D = kernels::laplacian<Dim>(D + i, sy, sz, second);
    const double lap_p = kernels::laplacian<Dim>(p + i, sy, sz, second);
    rows.product[0][i] = -D[i] * lap_D;
    rows.product[1][i] = lap_D * lap_D;
    rows.product[2][i] = lap_p * lap_p;
    rows.product[3][i] = D[i] * lap_p;
    rows.product[4][i] = lap_D * lap_p;
    rows.product[5][i] = p[i];
  }
}

EULASTIC_CLONES void products_2d(const Segment &s, ConstView D, ConstView p, const double *second, const SumRows &r) {
  products<2>(s, D, p, second, r);
}
EULASTIC_CLONES void products_3d(const Segment &s, ConstView D, ConstView p, const double *second, const SumRows &r) {
  products<3>(s, D, p, second, r);
}

EULASTIC_CLONES void increment_rows(const Grid &grid, double kappa, double g, double inverse_dt, double mean,
                                    ConstView D, ConstView p, View out) {
  const Int3 n = grid.owned();
  const int gz = grid.dimension() == 3 ? 1 : 0;
  for (int k = -gz; k < n[2] + gz; ++k)
    for (int j = -1; j < n[1] + 1; ++j) {
      const double *DD = D.row(j, k), *pp = p.row(j, k);
      double *dp = out.row(j, k);
#pragma omp simd
      for (int i = -1; i < n[0] + 1; ++i)
        dp[i] = -inverse_dt * kernels::fma(kappa, DD[i], g * (pp[i] - mean)) - mean;
    }
}

}  // namespace

double AcmCoefficients::sound_speed(double dt) const { return std::sqrt(kappa) / dt; }
double AcmCoefficients::relaxation() const { return kappa > 0 ? g / kappa : 0; }

AcmCoefficients acm_coefficients(const AcmSums &s) {
  if (!(s.A2 > 0)) return {};
  const double determinant = s.A2 * s.A3 - s.B2 * s.B2;
  const double kappa = s.A1 * s.A3 + s.B1 * s.B2;   // times the determinant
  const double g = -(s.B1 * s.A2 + s.A1 * s.B2);
  if (determinant > 1e-12 * s.A2 * s.A3 && kappa > 0 && g >= 0) return {kappa / determinant, g / determinant};
  return {s.A1 / s.A2, 0};
}

PetscErrorCode AcmSolver::solve(double dt, const FieldBlock &divergence, FieldBlock &pressure, FieldBlock &increment) {
  PetscFunctionBeginUser;
  VerbScope scope(Verb::acm);
  const Int3 n = grid_->owned();
  const int dim = grid_->dimension();
  double second[3];
  for (int d = 0; d < 3; ++d) second[d] = 1 / (grid_->spacing()[d] * grid_->spacing()[d]);
  std::vector<double> scratch(static_cast<std::size_t>(n[0]) * sum_count);
  SumRows rows;
  for (int s = 0; s < sum_count; ++s) rows.product[s] = scratch.data() + static_cast<std::size_t>(s) * n[0];
  ExactSums sums(sum_count);
  for (int k = 0; k < n[2]; ++k)
    for (int j = 0; j < n[1]; ++j) {
      (dim == 2 ? products_2d : products_3d)({0, n[0], j, k}, divergence[0], pressure[0], second, rows);
      for (int s = 0; s < sum_count; ++s) sums.add_row(s, rows.product[s], n[0], grid_->layout().begin[0]);
    }
  double total[sum_count];
  PetscCall(sums.reduce(grid_->comm(), total));
  last_ = acm_coefficients({total[0], total[1], total[2], total[3], total[4]});
  sound_speed_ = last_.sound_speed(dt);
  increment_rows(*grid_, last_.kappa, last_.g, 1 / dt, total[5] / grid_->cell_count(), divergence[0], pressure[0],
                 increment[0]);
  scope.flops(grid_->owned_count() * (2 * (4 * dim + 1) + 12 + 6));
  PetscFunctionReturn(0);
}

}  // namespace eulastic
