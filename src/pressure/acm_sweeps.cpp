#include "pressure/acm_sweeps.hpp"

#include "base/events.hpp"
#include "field/walls.hpp"
#include "kernels/momentum.hpp"
#include "pressure/row_sums.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace eulastic {
namespace {

constexpr int most = SweepSums::most;

// The Laplacians of all directions on one row, into rows of `pitch` doubles.
template <int Dim>
EULASTIC_INLINE void laplacians(const Segment &s, const ConstView *q, int count, InverseSquares h, double *rows,
                                std::ptrdiff_t pitch) {
  for (int f = 0; f < count; ++f) {
    const double *from = q[f].row(s.j, s.k);
    double *to = rows + f * pitch;
    const std::ptrdiff_t sy = q[f].sy, sz = q[f].sz;
#pragma omp simd
    for (int i = s.i_begin; i < s.i_end; ++i) to[i] = kernels::laplacian<Dim>(from + i, sy, sz, h);
  }
}

// Sums over the owned cells, in the order D D, q_0, (D L_i), (L_i L_j, j <= i).
struct SumTask {
  const Grid *grid;
  ConstView residual;
  const ConstView *q;
  int count;
  InverseSquares h;
  double *rows;
};

constexpr int sum_count(int directions) { return 2 + directions + directions * (directions + 1) / 2; }

template <int Dim, int Directions>
EULASTIC_INLINE void add_sums(const SumTask &t, ExactSums &sums) {
  const Int3 n = t.grid->owned();
  const std::int64_t begin = t.grid->layout().begin[0];
  for (int k = 0; k < n[2]; ++k)
    for (int j = 0; j < n[1]; ++j) {
      laplacians<Dim>({0, n[0], j, k}, t.q, Directions, t.h, t.rows, n[0]);
      const double *D = t.residual.row(j, k), *q0 = t.q[0].row(j, k);
      const double *L = t.rows;
      const std::ptrdiff_t pitch = n[0];
      const auto products = [=](int i, auto add) EULASTIC_BODY {
        int s = 0;
        add(s++, D[i], D[i]);
        add(s++, q0[i], 1);
#pragma GCC unroll 4
        for (int f = 0; f < Directions; ++f) add(s++, D[i], L[f * pitch + i]);
#pragma GCC unroll 4
        for (int f = 0; f < Directions; ++f)
#pragma GCC unroll 4
          for (int g = 0; g <= f; ++g) add(s++, L[f * pitch + i], L[g * pitch + i]);
      };
      add_row_sums<sum_count(Directions)>(n[0], begin, products, sums);
    }
}

template <int Dim>
EULASTIC_INLINE void add_sums(const SumTask &t, ExactSums &sums) {
  static_assert(most == 4, "one case for every number of directions");
  switch (t.count) {
    case 1:
      return add_sums<Dim, 1>(t, sums);
    case 2:
      return add_sums<Dim, 2>(t, sums);
    case 3:
      return add_sums<Dim, 3>(t, sums);
    default:
      return add_sums<Dim, 4>(t, sums);
  }
}

EULASTIC_CLONES void add_sums_2d(const SumTask &t, ExactSums &sums) { add_sums<2>(t, sums); }
EULASTIC_CLONES void add_sums_3d(const SumTask &t, ExactSums &sums) { add_sums<3>(t, sums); }

// d = sum c_i q_i - shift and increment += scale d, both in one ghost layer too; D -= sum c_i lap q_i, owned.
struct StepTask {
  const Grid *grid;
  const ConstView *q;
  int count;
  const double *coefficient;
  InverseSquares h;
  double shift, scale;
  bool last;  // leaves D and d alone
  ConstView residual;
  View new_residual, new_direction, increment;
  double *row;
};

template <int Dim>
EULASTIC_INLINE void take_step(const StepTask &t) {
  const Int3 n = t.grid->owned();
  const int gz = Dim == 3 ? 1 : 0;
  const InverseSquares h = t.h;
  const double shift = t.shift, scale = t.scale;
  for (int k = -gz; k < n[2] + gz; ++k)
    for (int j = -1; j < n[1] + 1; ++j) {
      double *d = t.row + 8;
      for (int i = -1; i < n[0] + 1; ++i) d[i] = -shift;
      for (int f = 0; f < t.count; ++f) {
        const double *q = t.q[f].row(j, k), c = t.coefficient[f];
#pragma omp simd
        for (int i = -1; i < n[0] + 1; ++i) d[i] = kernels::fma(c, q[i], d[i]);
      }
      double *increment = t.increment.row(j, k);
#pragma omp simd
      for (int i = -1; i < n[0] + 1; ++i) increment[i] = kernels::fma(scale, d[i], increment[i]);
      if (t.last) continue;
      std::copy(d - 1, d + n[0] + 1, t.new_direction.row(j, k) - 1);
      if (k < 0 || k >= n[2] || j < 0 || j >= n[1]) continue;
      const double *from = t.residual.row(j, k);
      double *D = t.new_residual.row(j, k);
      for (int f = 0; f < t.count; ++f) {
        const double *q = t.q[f].row(j, k), c = t.coefficient[f];
        const std::ptrdiff_t sy = t.q[f].sy, sz = t.q[f].sz;
        const double *old = f == 0 ? from : D;
#pragma omp simd
        for (int i = 0; i < n[0]; ++i) D[i] = kernels::fma(-c, kernels::laplacian<Dim>(q + i, sy, sz, h), old[i]);
      }
    }
}

EULASTIC_CLONES void take_step_2d(const StepTask &t) { take_step<2>(t); }
EULASTIC_CLONES void take_step_3d(const StepTask &t) { take_step<3>(t); }

}  // namespace

PetscErrorCode AcmSweepSolver::create(const Grid &grid, GhostExchange &exchange, const AcmSweepOptions &options,
                                      FieldBlock work) {
  PetscFunctionBeginUser;
  PetscCheck(options.sweeps_max >= 1 && options.memory >= 0 && options.memory <= most, grid.comm(),
             PETSC_ERR_ARG_OUTOFRANGE, "sweeps %d, memory %d", options.sweeps_max, options.memory);
  grid_ = &grid;
  exchange_ = &exchange;
  options_ = options;
  if (options.multigrid) {
    multigrid_ = std::make_unique<Multigrid>();
    PetscCall(multigrid_->create(grid));
  }
  work_ = std::move(work);
  int next = 0;
  for (FieldBlock *field : {&residual_, &correction_, &direction_, &scratch_}) *field = work_.part(next++, 1);
  if (options.memory > 0) memory_ = FieldBlock(grid, options.memory);
  rows_.resize(static_cast<std::size_t>(grid.owned()[0] + 16) * (most + 1));
  PetscFunctionReturn(0);
}

FieldBlock *AcmSweepSolver::memory() {
  ghosts_of_memory_ = false;
  return memory_ ? &memory_ : nullptr;
}

std::size_t AcmSweepSolver::bytes() const {
  return work_.bytes() + memory_.bytes() + (multigrid_ ? multigrid_->bytes() : 0);
}

PetscErrorCode AcmSweepSolver::update_ghosts(FieldBlock &field, int width) {
  PetscFunctionBeginUser;
  PetscCall(exchange_->update(field, width));
  for (int f = 0; f < field.count(); ++f) fill_wall_ghosts_even(*grid_, at_centre, field[f], 1);
  PetscFunctionReturn(0);
}

PetscErrorCode AcmSweepSolver::solve(double dt, const FieldBlock &divergence, FieldBlock &, FieldBlock &increment) {
  PetscFunctionBeginUser;
  VerbScope scope(Verb::acm);
  bool done = false;
  PetscCall(start(divergence));
  increment.fill(0, 0.0);
  if (memory_) {
    directions_.clear();
    for (int f = 0; f < memory_.count(); ++f) directions_.push_back(memory_[f]);
    PetscCall(sweep(false, dt, increment, &done));
  }
  for (int s = 1; s <= options_.sweeps_max && !done; ++s) {
    if (multigrid_) {
      PetscCall(multigrid_->apply(residual_, correction_, scratch_));
      fill_wall_ghosts_even(*grid_, at_centre, correction_[0], 1);
      scope.flops(multigrid_->flops());
    }
    directions_.assign(1, multigrid_ ? correction_[0] : residual_[0]);
    if (memory_ || s > 1) directions_.push_back(direction_[0]);
    PetscCall(sweep(s == options_.sweeps_max, dt, increment, &done));
    ++sweeps_;
  }
  if (memory_) remember(increment);
  PetscFunctionReturn(0);
}

PetscErrorCode AcmSweepSolver::sweep(bool last, double dt, FieldBlock &increment, bool *done) {
  PetscFunctionBeginUser;
  SweepMinimum minimum;
  double mean;
  PetscCall(find_minimum(&minimum, &mean));
  residual_rms_ = std::sqrt(minimum.square / grid_->cell_count());
  *done = last || !(residual_rms_ > target_);  // NaN is done
  const double count = static_cast<double>(directions_.size()), laplacian = 4 * grid_->dimension() + 1;
  PetscCall(PetscLogFlops(grid_->owned_count() * (count * (laplacian + 2) + 2 * sum_count(int(count)) + 2)));
  step(*done, dt, minimum, mean, increment);
  if (*done) PetscFunctionReturn(0);
  PetscCall(PetscLogFlops(grid_->owned_count() * count * (laplacian + 2)));
  PetscCall(update_ghosts(residual_, Multigrid::halo));
  PetscFunctionReturn(0);
}

PetscErrorCode AcmSweepSolver::start(const FieldBlock &divergence) {
  PetscFunctionBeginUser;
  for (const Segment &s : grid_->rows()) std::copy_n(divergence[0].row(s.j, s.k), s.size(), residual_[0].row(s.j, s.k));
  PetscCall(update_ghosts(residual_, Multigrid::halo));
  if (memory_ && !ghosts_of_memory_) PetscCall(update_ghosts(memory_, 1));
  ghosts_of_memory_ = true;
  PetscFunctionReturn(0);
}

PetscErrorCode AcmSweepSolver::find_minimum(SweepMinimum *minimum, double *mean) {
  PetscFunctionBeginUser;
  const int count = static_cast<int>(directions_.size());
  ExactSums exact(sum_count(count));
  (grid_->dimension() == 2 ? add_sums_2d : add_sums_3d)(
      {grid_, residual_[0], directions_.data(), count, grid_->inverse_squares(), rows_.data()}, exact);
  double total[sum_count(most)];
  PetscCall(exact.reduce(grid_->comm(), total));
  SweepSums sums;
  sums.directions = count;
  int s = 0;
  sums.square = total[s++];
  *mean = total[s++] / grid_->cell_count();
  for (int f = 0; f < count; ++f) sums.with[f] = total[s++];
  for (int f = 0; f < count; ++f)
    for (int g = 0; g <= f; ++g) sums.product[f][g] = total[s++];
  *minimum = minimise(sums);
  PetscFunctionReturn(0);
}

void AcmSweepSolver::step(bool last, double dt, const SweepMinimum &minimum, double mean, FieldBlock &increment) {
  // The stencils read D, when it is a direction itself, and d: the new ones go elsewhere.
  FieldBlock &new_residual = multigrid_ ? residual_ : correction_;
  (grid_->dimension() == 2 ? take_step_2d : take_step_3d)(
      {grid_, directions_.data(), static_cast<int>(directions_.size()), minimum.coefficient, grid_->inverse_squares(),
       minimum.coefficient[0] * mean, 1 / dt, last, residual_[0], new_residual[0], scratch_[0], increment[0],
       rows_.data()});
  if (last) return;
  direction_.swap(scratch_);
  if (!multigrid_) residual_.swap(correction_);
}

void AcmSweepSolver::remember(const FieldBlock &increment) {
  const std::size_t size = memory_.layout().size;
  std::memmove(memory_.data() + size, memory_.data(), sizeof(double) * size * (memory_.count() - 1));
  std::memcpy(memory_.data(), increment.data(), sizeof(double) * size);
}

}  // namespace eulastic
