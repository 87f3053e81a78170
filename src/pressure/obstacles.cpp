#include "pressure/obstacles.hpp"

#include "base/events.hpp"
#include "field/sides.hpp"
#include "kernels/momentum.hpp"
#include "pressure/row_sums.hpp"

#include <algorithm>
#include <cmath>

namespace eulastic {
namespace {

constexpr int patience = 12;  // iterations without progress: round-off

template <int Dim>
EULASTIC_INLINE void laplacian_rows(const Grid &grid, const RowPart &part, double dt, const FieldBlock &q,
                                    FieldBlock &out) {
  const InverseSquares h = grid.inverse_squares();
  const ConstView from = q[0];
  const std::ptrdiff_t sy = from.sy, sz = from.sz;
  for (const Segment &s : part.rows(grid)) {
    const double *u = from.row(s.j, s.k);
    double *to = out[0].row(s.j, s.k);
#pragma omp simd
    for (int i = s.i_begin; i < s.i_end; ++i) to[i] = dt * kernels::laplacian<Dim>(u + i, sy, sz, h);
  }
}
EULASTIC_CLONES void laplacian_2d(const Grid &grid, const RowPart &part, double dt, const FieldBlock &q,
                                  FieldBlock &out) {
  laplacian_rows<2>(grid, part, dt, q, out);
}
EULASTIC_CLONES void laplacian_3d(const Grid &grid, const RowPart &part, double dt, const FieldBlock &q,
                                  FieldBlock &out) {
  laplacian_rows<3>(grid, part, dt, q, out);
}

EULASTIC_CLONES void add_products(const Grid &grid, const RowPart &part, ConstView a, ConstView b, ConstView c,
                                  ConstView d, ExactSums &sums) {
  for (const Segment &s : part.rows(grid)) {
    const double *p = a.row(s.j, s.k), *q = b.row(s.j, s.k), *r = c.row(s.j, s.k), *t = d.row(s.j, s.k);
    const auto products = [=](int i, auto add) EULASTIC_BODY {
      add(0, p[i], q[i]);
      add(1, r[i], t[i]);
    };
    add_row_sums<2>(s.size(), grid.layout().begin[0], products, sums);
  }
}

// to = scale to + factor from, with a layer of ghosts.
EULASTIC_CLONES void combine(const Grid &grid, const RowPart &owned, double scale, double factor, const FieldBlock &from,
                             FieldBlock &to) {
  const RowPart part = owned.with_ghosts(grid);
  const int n = grid.owned()[0];
  for (int k = part.k_begin; k < part.k_end; ++k)
    for (int j = part.j_begin; j < part.j_end; ++j) {
      const double *x = from[0].row(j, k);
      double *y = to[0].row(j, k);
#pragma omp simd
      for (int i = -1; i < n + 1; ++i) y[i] = kernels::fma(factor, x[i], scale * y[i]);
    }
}

void combine_all(const Grid &grid, double scale, double factor, const FieldBlock &from, FieldBlock &to) {
  in_row_parts(grid, [&](const RowPart &part) { combine(grid, part, scale, factor, from, to); });
}

}  // namespace

ObstacleSolver::ObstacleSolver(const Grid &grid, GhostExchange &exchange, WorkSpace &work, const RigidFaces &faces,
                               double accuracy, std::unique_ptr<PressureSolver> other)
    : grid_(&grid), exchange_(&exchange), work_(&work), other_(std::move(other)), accuracy_(accuracy) {
  find_closed(faces);
}

std::size_t ObstacleSolver::bytes() const {
  return other_->bytes() + closed_.capacity() * sizeof(Closed) + first_.capacity() * sizeof(std::size_t);
}

void ObstacleSolver::find_closed(const RigidFaces &faces) {
  const Int3 &n = grid_->owned();
  for (const Segment &row : grid_->rows()) {
    first_.push_back(closed_.size());
    std::vector<unsigned> closed(n[0]);
    for (int d = 0; d < grid_->dimension(); ++d)
      for (int high = 0; high < 2; ++high) {
        const int j = row.j + (d == 1 && high), k = row.k + (d == 2 && high), shift = d == 0 && high;
        const RigidFaces::Row inside = faces.row(d, j, k);
        for (const RigidFaces::Run *run = inside.runs; run != inside.runs_end; ++run)
          for (int i = std::max(run->begin - shift, 0); i < std::min(run->end - shift, n[0]); ++i)
            closed[i] |= 1U << (2 * d + high);
      }
    for (int i = 0; i < n[0]; ++i)
      if (closed[i] != 0) closed_.push_back({i, closed[i]});
  }
  first_.push_back(closed_.size());
}

// dt div(open grad q); q has a layer of ghosts.
void ObstacleSolver::apply(double dt, const FieldBlock &q, FieldBlock &out) const {
  in_row_parts(*grid_, [&](const RowPart &part) {
    (grid_->dimension() == 2 ? laplacian_2d : laplacian_3d)(*grid_, part, dt, q, out);
  });
  const ConstView from = q[0];
  const Real3 &h = grid_->spacing();
  std::size_t at = 0;
  for (const Segment &row : grid_->rows()) {
    const double *u = from.row(row.j, row.k);
    double *to = out[0].row(row.j, row.k);
    for (std::size_t c = first_[at]; c < first_[at + 1]; ++c) {
      const int i = closed_[c].i;
      double sum = 0;
      for (int d = 0; d < grid_->dimension(); ++d) {
        const std::ptrdiff_t s = from.stride(d);
        const double low = closed_[c].faces >> (2 * d) & 1U ? 0 : u[i - s] - u[i];
        const double high = closed_[c].faces >> (2 * d + 1) & 1U ? 0 : u[i + s] - u[i];
        sum += (low + high) / (h[d] * h[d]);
      }
      to[i] = dt * sum;
    }
    ++at;
  }
}

PetscErrorCode ObstacleSolver::products(const FieldBlock &a, const FieldBlock &b, const FieldBlock &c,
                                        const FieldBlock &d, double *ab, double *cd) const {
  PetscFunctionBeginUser;
  double total[2];
  PetscCall(sum_row_parts(
      *grid_, 2,
      [&](const RowPart &part, ExactSums &sums) { add_products(*grid_, part, a[0], b[0], c[0], d[0], sums); }, total));
  *ab = total[0];
  *cd = total[1];
  PetscFunctionReturn(0);
}

PetscErrorCode ObstacleSolver::solve(double dt, const FieldBlock &divergence, FieldBlock &pressure,
                                     FieldBlock &increment) {
  PetscFunctionBeginUser;
  WorkSpace::Lease lease;
  PetscCall(work_->take("pressure around rigid bodies", work_fields, &lease));
  FieldBlock residual = lease.part(0, 1), direction = lease.part(1, 1), image = lease.part(2, 1),
             correction = lease.part(3, 1);
  residual.copy_from(divergence);
  increment.clear();
  double square, ignored, last = 0;
  PetscCall(products(residual, residual, residual, residual, &square, &ignored));
  const double cells = grid_->cell_count();
  double best = square;
  for (int n = 0, since = 0; n < most_iterations && since < patience; ++n, ++since) {
    const double rms = std::sqrt(square / cells);
    if (!(rms > target_)) break;
    constexpr double inner = 0.1;  // of the residual, in a direction
    other_->set_target(inner * rms);
    PetscCall(other_->solve(dt, residual, pressure, correction));
    double along = 0, before = 0;  // <z, r> and, of the next direction, <z, change of r>
    if (n == 0) {
      direction.copy_from(correction);
      PetscCall(products(correction, residual, correction, residual, &along, &ignored));
    } else {
      // `image` still holds A p of the step before: r has changed by -alpha A p.
      PetscCall(products(correction, residual, correction, image, &along, &before));
      combine_all(*grid_, before == 0 ? 0 : -before / last, 1, correction, direction);
    }
    apply(dt, direction, image);
    double curvature, projection;
    PetscCall(products(direction, image, direction, residual, &curvature, &projection));
    if (curvature == 0) break;
    const double step = projection / curvature;
    combine_all(*grid_, 1, step, direction, increment);
    combine_all(*grid_, 1, -step, image, residual);
    last = curvature;
    PetscCall(exchange_->update(residual, 1));
    fill_wall_ghosts_even(*grid_, at_centre, residual[0], 1);
    PetscCall(products(residual, residual, residual, residual, &square, &ignored));
    if (square < 0.5 * best) {
      best = square;
      since = 0;
    }
    ++iterations_;
  }
  PetscFunctionReturn(0);
}

}  // namespace eulastic
