#include "pressure/obstacles.hpp"

#include "base/events.hpp"
#include "field/extend_layer.hpp"
#include "field/open_boundaries.hpp"
#include "grid/sum_row_parts.hpp"
#include "kernels/momentum.hpp"
#include "pressure/row_sums.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace eulastic {
namespace {

constexpr double round_off = 1e-12;   // of the first residual; below it directions are noise
constexpr int stagnation_limit = 12;  // iterations without progress after which only round-off is left

template <int Dim>
EULASTIC_INLINE void laplacian_rows(const Box &box, const RowPart &part, double dt, const Field &q, Field &out) {
  const InverseSquares h = box.inverse_squares();
  const ConstView from = q[0];
  const std::ptrdiff_t sy = from.sy, sz = from.sz;
  for (const Segment &s : part.rows(box)) {
    const double *u = from.row(s.j, s.k);
    double *to = out[0].row(s.j, s.k);
#pragma omp simd
    for (int i = s.i_begin; i < s.i_end; ++i) to[i] = dt * kernels::laplacian<Dim>(u + i, sy, sz, h);
  }
}
EULASTIC_CLONES void laplacian_2d(const Box &box, const RowPart &part, double dt, const Field &q, Field &out) {
  laplacian_rows<2>(box, part, dt, q, out);
}
EULASTIC_CLONES void laplacian_3d(const Box &box, const RowPart &part, double dt, const Field &q, Field &out) {
  laplacian_rows<3>(box, part, dt, q, out);
}

EULASTIC_CLONES void add_products(const Box &box, const RowPart &part, ConstView a, ConstView b, ConstView c,
                                  ConstView d, ExactSums &sums) {
  for (const Segment &s : part.rows(box)) {
    const double *p = a.row(s.j, s.k), *q = b.row(s.j, s.k), *r = c.row(s.j, s.k), *t = d.row(s.j, s.k);
    const auto products = [=](int i, auto add) EULASTIC_BODY {
      add(0, p[i], q[i]);
      add(1, r[i], t[i]);
    };
    add_row_sums<2>(s.size(), box.layout().begin[0], products, sums);
  }
}

void add_values(const Box &box, const RowPart &part, ConstView a, ExactSums &sums) {
  for (const Segment &s : part.rows(box)) sums.add_row(0, a.row(s.j, s.k), s.size(), box.layout().begin[0]);
}

// to = scale to + factor from, including one ghost layer.
EULASTIC_CLONES void combine(const Box &box, const RowPart &owned, double scale, double factor, const Field &from,
                             Field &to) {
  const RowPart part = owned.with_ghosts(box);
  const int n = box.cells()[0];
  for (int k = part.k_begin; k < part.k_end; ++k)
    for (int j = part.j_begin; j < part.j_end; ++j) {
      const double *x = from[0].row(j, k);
      double *y = to[0].row(j, k);
#pragma omp simd
      for (int i = -1; i < n + 1; ++i) y[i] = kernels::fma(factor, x[i], scale * y[i]);
    }
}

void combine_all(const Box &box, double scale, double factor, const Field &from, Field &to) {
  in_row_parts(box, [&](const RowPart &part) { combine(box, part, scale, factor, from, to); });
  (void)PetscLogFlops(box.cell_count() * 3);
}

}  // namespace

ObstacleSolver::ObstacleSolver(const Domain &domain, GhostExchange &exchange, WorkSpace &work, const RigidFaces &faces,
                               double accuracy, int memory, std::unique_ptr<PressureSolver> preconditioner)
    : domain_(&domain),
      exchange_(&exchange),
      work_(&work),
      preconditioner_(std::move(preconditioner)),
      memory_(domain, memory),
      accuracy_(accuracy) {
  update_faces(faces);
}

std::size_t ObstacleSolver::bytes() const {
  return preconditioner_->bytes() + memory_.bytes() + cells_.capacity() * sizeof(CellAtBody) +
         first_.capacity() * sizeof(std::size_t);
}

bool ObstacleSolver::CellAtBody::closed() const {
  return std::all_of(open, open + 6, [](double part) { return part == 0; });
}

void ObstacleSolver::update_faces(const RigidFaces &faces) {
  closed_count_ = -1;
  cells_.clear();
  first_.clear();
  travels_ = faces.travels;
  const Int3 &n = domain_->cells();
  const Real3 &h = domain_->spacing();
  // Openness of faces, and distance from a face to the surface through the cell, in parts of the spacing.
  std::vector<std::array<double, 6>> open(n[0]), depth(n[0]);
  std::vector<int> body(n[0]);
  for (const Segment &row : domain_->rows()) {
    first_.push_back(cells_.size());
    for (auto *cells : {&open, &depth})
      for (auto &cell : *cells) cell.fill(1);
    for (int d = 0; d < domain_->dimension(); ++d)
      for (int high = 0; high < 2; ++high) {
        const int shift = d == 0 && high, face = 2 * d + high;
        faces.find_bodies_beside(d, high, row.j, row.k, &body);
        for (int i = 0; i < n[0]; ++i)
          if (body[i] >= 0) open[i][face] = depth[i][face] = 0;
        const RigidFaces::Row beside = faces.row(d, row.j + (d == 1 && high), row.k + (d == 2 && high));
        for (const RigidFaces::Cut &cut : beside.cuts)
          if (const int i = cut.i - shift; i >= 0 && i < n[0]) {
            open[i][face] = cut.open;
            depth[i][face] = 1 / (cut.link[2 * d + !high] * h[d] * h[d]);
          }
      }
    for (int i = 0; i < n[0]; ++i) {
      if (std::all_of(open[i].begin(), open[i].end(), [](double part) { return part == 1; })) continue;
      CellAtBody cell{i, {}};
      std::copy_n(open[i].begin(), 2 * domain_->dimension(), cell.open);  // 2-D has no faces along z
      for (int d = 0; d < domain_->dimension(); ++d) {
        const double *at = &open[i][2 * d], *to = &depth[i][2 * d];
        cell.response = std::max(cell.response, at[0] > 0 && at[1] > 0 ? 0.5 * (at[0] + at[1]) : to[0] + to[1]);
      }
      cells_.push_back(cell);
    }
  }
  first_.push_back(cells_.size());
}

// Computes dt div(open grad q); q needs one valid ghost layer.
void ObstacleSolver::apply(double dt, const Field &q, Field &out) const {
  in_row_parts(*domain_, [&](const RowPart &part) {
    (domain_->dimension() == 2 ? laplacian_2d : laplacian_3d)(*domain_, part, dt, q, out);
  });
  (void)PetscLogFlops(domain_->cell_count() * (4 * domain_->dimension() + 1) +
                      double(cells_.size()) * (7 * domain_->dimension() + 1));
  const ConstView from = q[0];
  const Real3 &h = domain_->spacing();
  for_cells_at_bodies([&](const CellAtBody &cell, const Segment &row) {
    const double *u = from.row(row.j, row.k) + cell.i;
    double sum = 0;
    for (int d = 0; d < domain_->dimension(); ++d) {
      const std::ptrdiff_t s = from.stride(d);
      const double *open = cell.open + 2 * d;
      sum += (open[0] * (u[-s] - u[0]) + open[1] * (u[s] - u[0])) / (h[d] * h[d]);
    }
    out[0](cell.i, row.j, row.k) = dt * sum;
  });
}

// Adds a diagonal correction in nearly closed cells, whose faces the preconditioner regards as open. If bodies are at
// rest, earlier increments serve this purpose.
PetscErrorCode ObstacleSolver::add_diagonal_correction(double dt, const Field &residual, Field &correction) const {
  PetscFunctionBeginUser;
  const Real3 &h = domain_->spacing();
  for_cells_at_bodies([&](const CellAtBody &cell, const Segment &row) {
    double open = 0, all = 0;
    for (int d = 0; d < domain_->dimension(); ++d) {
      open += (cell.open[2 * d] + cell.open[2 * d + 1]) / (h[d] * h[d]);
      all += 2 / (h[d] * h[d]);
    }
    if (open > 0) correction[0](cell.i, row.j, row.k) -= (1 / open - 1 / all) / dt * residual[0](cell.i, row.j, row.k);
  });
  PetscCall(exchange_->update_ghosts(correction, 1));
  fill_ghosts_of_increment(*domain_, correction[0], 1);
  PetscFunctionReturn(0);
}

// Cells whose faces are all closed get 0, because they are not part of the equation, and values left there by the
// preconditioner would add up over the steps. If no boundary is open, the mean of the increment over the other cells
// becomes 0; if bodies travel, so that these cells change, the mean of the pressure over them becomes 0.
PetscErrorCode ObstacleSolver::normalise(const Field &pressure, Field &increment) {
  PetscFunctionBeginUser;
  const View q = increment[0];
  for_closed_cells([&](const Int3 &cell) { q(cell[0], cell[1], cell[2]) = 0; });
  if (!domain_->any_open()) {
    if (closed_count_ < 0) {
      closed_count_ = 0;
      for_closed_cells([&](const Int3 &) { ++closed_count_; });
      PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &closed_count_, 1, MPI_INT64_T, MPI_SUM, domain_->comm()));
    }
    const auto add = [&](const RowPart &part, ExactSums &sums) {
      add_values(*domain_, part, q, sums);
      if (!travels_) return;
      const ConstView p = pressure[0];
      add_values(*domain_, part, p, sums);
      if (part.first) for_closed_cells([&](const Int3 &cell) { sums.add(0, -p(cell[0], cell[1], cell[2])); });
    };
    double sum;
    PetscCall(sum_row_parts(*domain_, 1, add, &sum));
    const double mean = sum / std::max(1.0, domain_->domain_cell_count() - double(closed_count_));
    for (const Segment &row : domain_->rows())
      for (int i = row.i_begin; i < row.i_end; ++i) q(i, row.j, row.k) -= mean;
    for_closed_cells([&](const Int3 &cell) { q(cell[0], cell[1], cell[2]) = 0; });
  }
  PetscCall(exchange_->update_ghosts(increment, 1));
  fill_ghosts_of_increment(*domain_, q, 1);
  PetscFunctionReturn(0);
}

PetscErrorCode ObstacleSolver::products(const Field &a, const Field &b, const Field &c, const Field &d, double *ab,
                                        double *cd) const {
  PetscFunctionBeginUser;
  double total[2];
  PetscCall(sum_row_parts(
      *domain_, 2,
      [&](const RowPart &part, ExactSums &sums) { add_products(*domain_, part, a[0], b[0], c[0], d[0], sums); },
      total));
  PetscCall(PetscLogFlops(domain_->cell_count() * 4));
  *ab = total[0];
  *cd = total[1];
  PetscFunctionReturn(0);
}

PetscErrorCode ObstacleSolver::solve(double dt, const Field &divergence, Field &pressure, Field &increment) {
  PetscFunctionBeginUser;
  WorkSpace::Lease lease;
  PetscCall(work_->lease("pressure around rigid bodies", work_fields, &lease));
  Field residual = lease.part(0, 1), direction = lease.part(1, 1), image = lease.part(2, 1),
        correction = lease.part(3, 1);
  residual.copy_from(divergence);
  increment.clear();
  double square, ignored, last = 0;
  PetscCall(products(residual, residual, residual, residual, &square, &ignored));
  const double cells = domain_->domain_cell_count(), target = std::max(target_, round_off * std::sqrt(square / cells));
  const int remembered = memory_ ? memory_.count() : 0;
  if (memory_) PetscCall(memory_.update_ghosts(*domain_, *exchange_));
  double best = square;
  for (int n = 0, since = 0; n < most_iterations && since < stagnation_limit; ++n, ++since) {
    const double rms = std::sqrt(square / cells);
    if (!(rms > target)) break;
    if (n < remembered) {
      correction.copy_from(memory_.increment(n));
    } else {
      constexpr double inner = 0.1;  // relative residual for the preconditioner
      preconditioner_->set_target(inner * rms);
      PetscCall(preconditioner_->solve(dt, residual, pressure, correction));
      if (travels_) PetscCall(add_diagonal_correction(dt, residual, correction));
      ++iterations_;
    }
    if (n == 0 || last == 0) {
      direction.copy_from(correction);
    } else {  // `image` still is A p of the previous direction
      double coupling;
      PetscCall(products(correction, image, residual, residual, &coupling, &ignored));
      combine_all(*domain_, -coupling / last, 1, correction, direction);
    }
    apply(dt, direction, image);
    double curvature, projection;
    PetscCall(products(direction, image, direction, residual, &curvature, &projection));
    last = curvature;
    if (curvature == 0 && n < remembered) continue;  // the memory is still empty
    if (curvature == 0) break;
    const double step = projection / curvature;
    combine_all(*domain_, 1, step, direction, increment);
    combine_all(*domain_, 1, -step, image, residual);
    PetscCall(exchange_->update_ghosts(residual, 1));
    fill_ghosts_of_increment(*domain_, residual[0], 1);
    PetscCall(products(residual, residual, residual, residual, &square, &ignored));
    if (square < 0.5 * best) {
      best = square;
      since = 0;
    }
  }
  PetscCall(normalise(pressure, increment));
  if (memory_) {
    memory_.advance();
    memory_.increment(0).copy_from(increment);
  }
  PetscFunctionReturn(0);
}

// Pressure and its rotational update in cells beside or inside bodies.

namespace {

constexpr double least_open = 0.03;  // least factor by which D* is divided

}  // namespace

PetscErrorCode ObstacleSolver::extrapolate_into_closed(Field &pressure) const {
  PetscFunctionBeginUser;
  EventScope scope(Event::rigid);
  const Layout &layout = domain_->layout();
  const std::ptrdiff_t stride[3] = {1, layout.sy, layout.sz};
  WorkSpace::Lease lease;
  PetscCall(work_->lease("known pressure", 1, &lease));
  Field known = lease.part(0, 1);  // 1 in cells with a known pressure; else 0, also behind boundaries
  known.clear();
  for (const Segment &row : domain_->rows()) std::fill_n(known[0].row(row.j, row.k), row.size(), 1.0);
  for_closed_cells([&](const Int3 &cell) { known[0](cell[0], cell[1], cell[2]) = 0; });
  for (int layer = 1; layer <= 2; ++layer) {
    PetscCall(exchange_->update_ghosts(known, 1));
    PetscCall(exchange_->update_ghosts(pressure, 1));
    std::vector<LayerPoint> points;
    for_closed_cells([&](const Int3 &cell) {
      const std::ptrdiff_t at = layout.offset(cell[0], cell[1], cell[2]);
      const double *is_known = known.data() + at;
      const auto counts = [&](std::ptrdiff_t step) { return is_known[step] != 0; };
      const unsigned neighbours = *is_known != 0 ? 0 : neighbour_bits(domain_->dimension(), stride, counts);
      if (neighbours) points.emplace_back(at, neighbours, 0);
    });
    scope.flops(extend_layer<1>(points, Piece(points.size(), 0, 1), domain_->dimension(), stride, layout.size,
                                pressure.data()));
    for (const LayerPoint &point : points) known.data()[point.offset] = 1;
  }
  PetscFunctionReturn(0);
}

void ObstacleSolver::copy_closed(const Field &from, Field *to) const {
  for_closed_cells([&](const Int3 &cell) { (*to)[0](cell[0], cell[1], cell[2]) = from[0](cell[0], cell[1], cell[2]); });
}

PetscErrorCode ObstacleSolver::scale_divergence(double part, Field &divergence) const {
  PetscFunctionBeginUser;
  const int faces = 2 * domain_->dimension();
  for_cells_at_bodies([&](const CellAtBody &cell, const Segment &row) {
    const double open = std::accumulate(cell.open, cell.open + faces, 0.0) / faces;
    divergence[0](cell.i, row.j, row.k) /= std::max({least_open, open, part * cell.response});
  });
  PetscCall(exchange_->update_ghosts(divergence, 1));
  fill_ghosts_of_increment(*domain_, divergence[0], 1);
  PetscFunctionReturn(0);
}

}  // namespace eulastic
