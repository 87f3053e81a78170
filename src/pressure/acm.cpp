#include "pressure/acm.hpp"

#include "base/events.hpp"
#include "field/open_boundaries.hpp"
#include "grid/blocks.hpp"
#include "grid/sum_row_parts.hpp"
#include "kernels/stencils.hpp"
#include "pressure/row_sums.hpp"

#include <cmath>

namespace eulastic {
namespace {

constexpr int sum_count = 6;  // A1, A2, A3, B1, B2 of (13) and <p> of (6)

template <int Dim>
EULASTIC_INLINE void add_sums(const Box &box, const RowPart &part, ConstView divergence, ConstView pressure,
                              ExactSums &sums) {
  const Int3 n = box.cells();
  const std::int64_t begin = box.layout().begin[0];
  const InverseSquares h = box.inverse_squares();
  const std::ptrdiff_t sy = divergence.sy, sz = divergence.sz;
  for_rows_in_blocks(part, [&](int j, int k) EULASTIC_BODY {
    const double *D = divergence.row(j, k), *p = pressure.row(j, k);
    if (Dim == 3)
      for (const double *row : {D, p}) prefetch(row + 2 * sz, n[0]);
    const auto products = [=](int i, auto add) EULASTIC_BODY {
      const double lap_D = kernels::laplacian<Dim>(D + i, sy, sz, h), lap_p = kernels::laplacian<Dim>(p + i, sy, sz, h);
      add(0, -D[i], lap_D);
      add(1, lap_D, lap_D);
      add(2, lap_p, lap_p);
      add(3, D[i], lap_p);
      add(4, lap_D, lap_p);
      add(5, p[i], 1);
    };
    add_row_sums<sum_count>(n[0], begin, products, sums);
  });
}

EULASTIC_CLONES void add_sums_2d(const Box &box, const RowPart &part, ConstView D, ConstView p, ExactSums &s) {
  add_sums<2>(box, part, D, p, s);
}
EULASTIC_CLONES void add_sums_3d(const Box &box, const RowPart &part, ConstView D, ConstView p, ExactSums &s) {
  add_sums<3>(box, part, D, p, s);
}

// Evaluates the formula for the increment in all cells, ghosts included.
void increment_everywhere(const Box &box, const kernels::AcmIncrement &formula, const Field &divergence,
                          const Field &pressure, Field &increment) {
  in_row_parts(box, [&](const RowPart &owned) {
    const RowPart part = owned.with_ghosts(box);
    for (int k = part.k_begin; k < part.k_end; ++k)
      for (int j = part.j_begin; j < part.j_end; ++j) {
        const double *D = divergence[0].row(j, k), *p = pressure[0].row(j, k);
        double *out = increment[0].row(j, k);
        for (int i = -1; i < box.cells()[0] + 1; ++i) out[i] = formula(D[i], p[i]);
      }
  });
  fill_ghosts_of_increment(box, increment[0], 1);
}

}  // namespace

double AcmCoefficients::sound_speed(double dt) const { return std::sqrt(kappa) / dt; }
double AcmCoefficients::relaxation() const { return kappa > 0 ? g / kappa : 0; }

AcmCoefficients acm_coefficients(const AcmSums &s) {
  if (!(s.A2 > 0)) return {};
  const double determinant = s.A2 * s.A3 - s.B2 * s.B2;
  const double kappa = s.A1 * s.A3 + s.B1 * s.B2;  // times the determinant
  const double g = -(s.B1 * s.A2 + s.A1 * s.B2);
  if (determinant > 1e-12 * s.A2 * s.A3 && kappa > 0 && g >= 0) return {kappa / determinant, g / determinant};
  return {s.A1 / s.A2, 0};
}

PetscErrorCode AcmSolver::solve(double dt, const Field &divergence, Field &pressure, Field &increment) {
  PetscFunctionBeginUser;
  EventScope scope(Event::acm);
  const int dim = domain_->dimension();
  const bool open = domain_->any_open();
  if (open) fill_ghosts_of_increment(*domain_, pressure[0], 1);
  double total[sum_count];
  PetscCall(sum_row_parts(
      *domain_, sum_count,
      [&](const RowPart &part, ExactSums &sums) {
        (dim == 2 ? add_sums_2d : add_sums_3d)(*domain_, part, divergence[0], pressure[0], sums);
      },
      total));
  last_ = acm_coefficients({total[0], total[1], total[2], total[3], total[4]});
  sound_speed_ = last_.sound_speed(dt);
  formula_ = {last_.kappa, last_.g, 1 / dt, open ? 0 : total[5] / domain_->domain_cell_count()};
  if (open) increment_everywhere(*domain_, formula_, divergence, pressure, increment);
  scope.flops(domain_->cell_count() * (2 * (4 * dim + 1) + 12));
  PetscFunctionReturn(0);
}

}  // namespace eulastic
