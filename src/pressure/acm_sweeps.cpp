#include "pressure/acm_sweeps.hpp"

#include "base/events.hpp"
#include "field/walls.hpp"
#include "grid/blocks.hpp"
#include "kernels/momentum.hpp"
#include "kernels/stencils.hpp"
#include "pressure/row_sums.hpp"

#include <algorithm>
#include <cmath>
#include <type_traits>

namespace eulastic {
namespace {

constexpr int most = SweepSums::most;

// work(count) with the number of directions as a constant.
template <class Work>
EULASTIC_INLINE void for_directions(int count, Work work) {
  static_assert(most == 4, "one case for every number of directions");
  if (count == 1) return work(std::integral_constant<int, 1>{});
  if (count == 2) return work(std::integral_constant<int, 2>{});
  if (count == 3) return work(std::integral_constant<int, 3>{});
  work(std::integral_constant<int, 4>{});
}

// Sums over the owned cells, in the order D D, q_0, (D L_i), (L_i L_j, j <= i).
struct SumTask {
  const Grid *grid;
  ConstView residual;
  const ConstView *q;
  int count;
  InverseSquares h;
};

constexpr int sum_count(int directions) { return 2 + directions + directions * (directions + 1) / 2; }

template <int Dim, int Directions>
EULASTIC_INLINE void add_sums(const SumTask &t, const RowPart &part, ExactSums &sums) {
  const Int3 n = t.grid->owned();
  const std::int64_t begin = t.grid->layout().begin[0];
  const InverseSquares h = t.h;
  const std::ptrdiff_t sy = t.residual.sy, sz = t.residual.sz;
  for_rows_in_blocks(part, [&](int j, int k) EULASTIC_BODY {
    const double *D = t.residual.row(j, k), *q[Directions];
    if (Dim == 3) kernels::prefetch(D + sz, n[0]);
    for (int f = 0; f < Directions; ++f) {
      q[f] = t.q[f].row(j, k);
      if (Dim == 3) kernels::prefetch(q[f] + 2 * sz, n[0]);
    }
    const auto products = [=](int i, auto add) EULASTIC_BODY {
      double L[Directions];
      int s = 0;
      add(s++, D[i], D[i]);
      add(s++, q[0][i], 1);
#pragma GCC unroll 4
      for (int f = 0; f < Directions; ++f) {
        L[f] = kernels::laplacian<Dim>(q[f] + i, sy, sz, h);
        add(s++, D[i], L[f]);
      }
#pragma GCC unroll 4
      for (int f = 0; f < Directions; ++f)
#pragma GCC unroll 4
        for (int g = 0; g <= f; ++g) add(s++, L[f], L[g]);
    };
    add_row_sums<sum_count(Directions)>(n[0], begin, products, sums);
  });
}

template <int Dim>
EULASTIC_INLINE void add_sums(const SumTask &t, const RowPart &part, ExactSums &sums) {
  for_directions(t.count, [&](auto count) EULASTIC_BODY { add_sums<Dim, count()>(t, part, sums); });
}

EULASTIC_CLONES void add_sums_2d(const SumTask &t, const RowPart &part, ExactSums &sums) { add_sums<2>(t, part, sums); }
EULASTIC_CLONES void add_sums_3d(const SumTask &t, const RowPart &part, ExactSums &sums) { add_sums<3>(t, part, sums); }

// What a sweep does to the increment. Every second one leaves its d to the next, which still has it.
enum class Increment { later, set, set_two, add, add_two };

// d = sum c_i q_i - shift and increment += scale d, both in one ghost layer too; D -= sum c_i lap q_i, owned.
struct StepTask {
  const Grid *grid;
  const ConstView *q;  // the last one is the d before this one, where there is such a thing
  int count;
  const double *coefficient;
  InverseSquares h;
  double shift, scale;
  Increment how;
  bool last;  // leaves D and d alone
  ConstView residual;
  View new_residual, new_direction, increment;
};

template <int Dim, int Directions, Increment How>
EULASTIC_INLINE void take_step(const StepTask &t, const RowPart &part) {
  constexpr bool adds = How == Increment::add || How == Increment::add_two,
                 two = How == Increment::set_two || How == Increment::add_two;
  const Int3 n = t.grid->owned();
  const InverseSquares h = t.h;
  const double shift = t.shift, scale = t.scale;
  const std::ptrdiff_t sy = t.increment.sy, sz = t.increment.sz;
  double c[Directions];
  std::copy_n(t.coefficient, Directions, c);
  for_rows_in_blocks(part, [&](int j, int k) EULASTIC_BODY {
    const double *q[Directions];
    for (int f = 0; f < Directions; ++f) q[f] = t.q[f].row(j, k);
    double *increment = t.increment.row(j, k), *direction = t.new_direction.row(j, k);
    const auto move = [=](int i) EULASTIC_BODY {
      double d = -shift;
#pragma GCC unroll 4
      for (int f = 0; f < Directions; ++f) d = kernels::fma(c[f], q[f][i], d);
      double sum = adds ? increment[i] : 0;
      if (two) sum = kernels::fma(scale, q[Directions - 1][i], sum);
      if (How != Increment::later) increment[i] = kernels::fma(scale, d, sum);
      return d;
    };
    if (t.last) {
#pragma omp simd
      for (int i = -1; i < n[0] + 1; ++i) move(i);
      return;
    }
    if (k < 0 || k >= n[2] || j < 0 || j >= n[1]) {
#pragma omp simd
      for (int i = -1; i < n[0] + 1; ++i) direction[i] = move(i);
      return;
    }
    const double *from = t.residual.row(j, k);
    double *D = t.new_residual.row(j, k);
    for (const int i : {-1, n[0]}) direction[i] = move(i);
#pragma omp simd
    for (int i = 0; i < n[0]; ++i) {
      direction[i] = move(i);
      double rest = from[i];
#pragma GCC unroll 4
      for (int f = 0; f < Directions; ++f)
        rest = kernels::fma(-c[f], kernels::laplacian<Dim>(q[f] + i, sy, sz, h), rest);
      D[i] = rest;
    }
  });
}

template <int Dim>
EULASTIC_INLINE void take_step(const StepTask &t, const RowPart &part) {
  for_directions(t.count, [&](auto count) EULASTIC_BODY {
    if (t.how == Increment::later) return take_step<Dim, count(), Increment::later>(t, part);
    if (t.how == Increment::set) return take_step<Dim, count(), Increment::set>(t, part);
    if constexpr (count() == 2) {  // a new direction and d
      if (t.how == Increment::set_two) return take_step<Dim, 2, Increment::set_two>(t, part);
      if (t.how == Increment::add) return take_step<Dim, 2, Increment::add>(t, part);
      take_step<Dim, 2, Increment::add_two>(t, part);
    }
  });
}

EULASTIC_CLONES void take_step_2d(const StepTask &t, const RowPart &part) { take_step<2>(t, part); }
EULASTIC_CLONES void take_step_3d(const StepTask &t, const RowPart &part) { take_step<3>(t, part); }

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
  PetscFunctionReturn(0);
}

FieldBlock *AcmSweepSolver::memory() {
  if (!memory_) return nullptr;
  const std::size_t size = memory_.layout().size;
  double *data = memory_.data();
  std::rotate(data, data + newest_ * size, data + memory_.count() * size);
  newest_ = 0;
  ghosts_of_memory_ = false;
  return &memory_;
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
  first_ = true;
  left_ = false;
  if (memory_) {
    if (!ghosts_of_memory_) PetscCall(update_ghosts(memory_, 1));
    ghosts_of_memory_ = true;
    directions_.clear();
    for (int f = 0; f < memory_.count(); ++f) directions_.push_back(memory_[(newest_ + f) % memory_.count()]);
    PetscCall(sweep({false, divergence, increment}, dt, &done));
  } else {
    for (const Segment &s : grid_->rows())
      std::copy_n(divergence[0].row(s.j, s.k), s.size(), residual_[0].row(s.j, s.k));
    PetscCall(update_ghosts(residual_, Multigrid::halo));
  }
  for (int s = 1; s <= options_.sweeps_max && !done; ++s) {
    if (multigrid_) {
      PetscCall(multigrid_->apply(residual_, correction_, scratch_));
      fill_wall_ghosts_even(*grid_, at_centre, correction_[0], 1);
      scope.flops(multigrid_->flops());
    }
    directions_.assign(1, multigrid_ ? correction_[0] : residual_[0]);
    if (memory_ || s > 1) directions_.push_back(direction_[0]);
    PetscCall(sweep({s == options_.sweeps_max, residual_, increment}, dt, &done));
    ++sweeps_;
  }
  if (memory_) remember(increment);
  PetscFunctionReturn(0);
}

PetscErrorCode AcmSweepSolver::sweep(const Turn &turn, double dt, bool *done) {
  PetscFunctionBeginUser;
  SweepMinimum minimum;
  double mean;
  PetscCall(find_minimum(turn.residual, &minimum, &mean));
  residual_rms_ = std::sqrt(minimum.square / grid_->cell_count());
  *done = turn.last || !(residual_rms_ > target_);  // NaN is done
  const double count = static_cast<double>(directions_.size()), laplacian = 4 * grid_->dimension() + 1;
  PetscCall(PetscLogFlops(grid_->owned_count() * (count * (laplacian + 2) + 2 * sum_count(int(count)) + 2)));
  step(turn, *done, dt, minimum, mean);
  if (*done) PetscFunctionReturn(0);
  PetscCall(PetscLogFlops(grid_->owned_count() * count * (laplacian + 2)));
  PetscCall(update_ghosts(residual_, Multigrid::halo));
  PetscFunctionReturn(0);
}

PetscErrorCode AcmSweepSolver::find_minimum(const FieldBlock &residual, SweepMinimum *minimum, double *mean) {
  PetscFunctionBeginUser;
  const int count = static_cast<int>(directions_.size());
  const SumTask task{grid_, residual[0], directions_.data(), count, grid_->inverse_squares()};
  const auto add = [&](const RowPart &part, ExactSums &exact) {
    (grid_->dimension() == 2 ? add_sums_2d : add_sums_3d)(task, part, exact);
  };
  double total[sum_count(most)];
  PetscCall(sum_row_parts(*grid_, sum_count(count), add, total));
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

void AcmSweepSolver::step(const Turn &turn, bool last, double dt, const SweepMinimum &minimum, double mean) {
  // The stencils read D, when it is a direction itself, and d: the new ones go elsewhere.
  FieldBlock &new_residual = multigrid_ ? residual_ : correction_;
  const bool left = left_;  // an increment by the sweep before
  const Increment how = !left && !last ? Increment::later
                        : first_       ? (left ? Increment::set_two : Increment::set)
                                       : (left ? Increment::add_two : Increment::add);
  left_ = how == Increment::later;
  if (!left_) first_ = false;
  const StepTask task{grid_,
                      directions_.data(),
                      static_cast<int>(directions_.size()),
                      minimum.coefficient,
                      grid_->inverse_squares(),
                      minimum.coefficient[0] * mean,
                      1 / dt,
                      how,
                      last,
                      turn.residual[0],
                      new_residual[0],
                      scratch_[0],
                      turn.increment[0]};
  in_row_parts(*grid_, [&](const RowPart &part) {
    (grid_->dimension() == 2 ? take_step_2d : take_step_3d)(task, part.with_ghosts(*grid_));
  });
  if (last) return;
  direction_.swap(scratch_);
  if (!multigrid_) residual_.swap(correction_);
}

void AcmSweepSolver::remember(const FieldBlock &increment) {
  newest_ = (newest_ + memory_.count() - 1) % memory_.count();
  memory_.part(newest_, 1).copy_from(increment);
}

}  // namespace eulastic
