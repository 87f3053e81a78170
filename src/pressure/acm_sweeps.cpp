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

// work(count, recurs) with both as constants: a direction of the recurrence has one stencil beside it.
template <class Work>
EULASTIC_INLINE void for_directions(int stencils, bool recurs, Work work) {
  static_assert(most == 4, "one case for every number of directions");
  using No = std::false_type;
  if (recurs) return work(std::integral_constant<int, 1>{}, std::true_type{});
  if (stencils == 1) return work(std::integral_constant<int, 1>{}, No{});
  if (stencils == 2) return work(std::integral_constant<int, 2>{}, No{});
  if (stencils == 3) return work(std::integral_constant<int, 3>{}, No{});
  work(std::integral_constant<int, 4>{}, No{});
}

// D and the directions that it is minimised over: q_f, whose Laplacians L_f are taken, and, if `recurs`, the d before,
// of which L = D before - D.
struct SweepTask {
  const Grid *grid;
  const ConstView *q;
  int stencils;
  bool recurs;
  ConstView residual, before;
  InverseSquares h;
};

// Sums over the owned cells, in the order D D, q_0, (D L_i), (L_i L_j, j <= i).
constexpr int sum_count(int directions) { return 2 + directions + directions * (directions + 1) / 2; }

template <int Dim, int Stencils, bool Recurs>
EULASTIC_INLINE void add_sums(const SweepTask &t, const RowPart &part, ExactSums &sums) {
  constexpr int directions = Stencils + Recurs;
  const Int3 n = t.grid->owned();
  const std::int64_t begin = t.grid->layout().begin[0];
  const InverseSquares h = t.h;
  const std::ptrdiff_t sy = t.residual.sy, sz = t.residual.sz;
  for_rows_in_blocks(part, [&](int j, int k) EULASTIC_BODY {
    const double *D = t.residual.row(j, k), *before = Recurs ? t.before.row(j, k) : nullptr, *q[Stencils];
    if (Dim == 3) kernels::prefetch(D + sz, n[0]);
    if (Dim == 3 && Recurs) kernels::prefetch(before + sz, n[0]);
    for (int f = 0; f < Stencils; ++f) {
      q[f] = t.q[f].row(j, k);
      if (Dim == 3) kernels::prefetch(q[f] + 2 * sz, n[0]);
    }
    const auto products = [=](int i, auto add) EULASTIC_BODY {
      double L[directions];
      int s = 0;
      add(s++, D[i], D[i]);
      add(s++, q[0][i], 1);
#pragma GCC unroll 4
      for (int f = 0; f < directions; ++f) {
        L[f] = f < Stencils ? kernels::laplacian<Dim>(q[f] + i, sy, sz, h) : before[i] - D[i];
        add(s++, D[i], L[f]);
      }
#pragma GCC unroll 4
      for (int f = 0; f < directions; ++f)
#pragma GCC unroll 4
        for (int g = 0; g <= f; ++g) add(s++, L[f], L[g]);
    };
    add_row_sums<sum_count(directions)>(n[0], begin, products, sums);
  });
}

template <int Dim>
EULASTIC_INLINE void add_sums(const SweepTask &t, const RowPart &part, ExactSums &sums) {
  for_directions(t.stencils, t.recurs,
                 [&](auto stencils, auto recurs) EULASTIC_BODY { add_sums<Dim, stencils(), recurs()>(t, part, sums); });
}

EULASTIC_CLONES void add_sums_2d(const SweepTask &t, const RowPart &part, ExactSums &sums) {
  add_sums<2>(t, part, sums);
}
EULASTIC_CLONES void add_sums_3d(const SweepTask &t, const RowPart &part, ExactSums &sums) {
  add_sums<3>(t, part, sums);
}

// The coefficients of the directions, and the mean of q_0. What D before - D has of rounding must not count: a d that
// moved D by less than a millionth is left out.
PetscErrorCode find_minimum(const SweepTask &task, SweepMinimum *minimum, double *mean) {
  PetscFunctionBeginUser;
  const int count = task.stencils + task.recurs;
  const auto add = [&](const RowPart &part, ExactSums &exact) {
    (task.grid->dimension() == 2 ? add_sums_2d : add_sums_3d)(task, part, exact);
  };
  double total[sum_count(most)];
  PetscCall(sum_row_parts(*task.grid, sum_count(count), add, total));
  SweepSums sums;
  sums.directions = count;
  int s = 0;
  sums.square = total[s++];
  *mean = total[s++] / task.grid->cell_count();
  for (int f = 0; f < count; ++f) sums.with[f] = total[s++];
  for (int f = 0; f < count; ++f)
    for (int g = 0; g <= f; ++g) sums.product[f][g] = total[s++];
  const int d = count - 1;
  if (task.recurs && sums.product[d][d] < 1e-12 * sums.square) {
    sums.with[d] = 0;
    std::fill_n(sums.product[d], count, 0);
  }
  *minimum = minimise(sums);
  PetscFunctionReturn(0);
}

// What a sweep does to the increment. Every second one leaves its d to the next, which still has it.
enum class Increment { later, set, set_two, add, add_two };

// d = sum c_i q_i + c d - shift, in place, and increment += scale d, both in one ghost layer too; new D = D - sum c_i
// L_i, owned, which may be where `before` is.
struct StepTask : SweepTask {
  const double *coefficient;
  double shift, scale;
  Increment how;
  bool last;  // leaves D and d alone
  View new_residual, direction, increment;
};

template <int Dim, int Stencils, bool Recurs, Increment How>
EULASTIC_INLINE void take_step(const StepTask &t, const RowPart &part) {
  constexpr bool adds = How == Increment::add || How == Increment::add_two,
                 two = How == Increment::set_two || How == Increment::add_two;
  const Int3 n = t.grid->owned();
  const InverseSquares h = t.h;
  const double shift = t.shift, scale = t.scale;
  const std::ptrdiff_t sy = t.increment.sy, sz = t.increment.sz;
  double c[Stencils + Recurs];
  std::copy_n(t.coefficient, Stencils + Recurs, c);
  for_rows_in_blocks(part, [&](int j, int k) EULASTIC_BODY {
    const double *q[Stencils];
    for (int f = 0; f < Stencils; ++f) q[f] = t.q[f].row(j, k);
    double *increment = t.increment.row(j, k), *direction = t.direction.row(j, k);
    const auto move = [=](int i) EULASTIC_BODY {
      double d = -shift;
#pragma GCC unroll 4
      for (int f = 0; f < Stencils; ++f) d = kernels::fma(c[f], q[f][i], d);
      if (Recurs) d = kernels::fma(c[Stencils], direction[i], d);
      double sum = adds ? increment[i] : 0;
      if (two) sum = kernels::fma(scale, direction[i], sum);
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
    const double *D = t.residual.row(j, k), *before = Recurs ? t.before.row(j, k) : nullptr;
    double *out = t.new_residual.row(j, k);
    for (const int i : {-1, n[0]}) direction[i] = move(i);
#pragma omp simd
    for (int i = 0; i < n[0]; ++i) {
      direction[i] = move(i);
      double rest = D[i];
#pragma GCC unroll 4
      for (int f = 0; f < Stencils; ++f) rest = kernels::fma(-c[f], kernels::laplacian<Dim>(q[f] + i, sy, sz, h), rest);
      if (Recurs) rest = kernels::fma(-c[Stencils], before[i] - D[i], rest);
      out[i] = rest;
    }
    if (t.grid->wraps_x()) t.grid->wrap_row(out, Multigrid::halo);
  });
}

template <int Dim>
EULASTIC_INLINE void take_step(const StepTask &t, const RowPart &part) {
  for_directions(t.stencils, t.recurs, [&](auto stencils, auto recurs) EULASTIC_BODY {
    constexpr int count = stencils();
    if (t.how == Increment::later) return take_step<Dim, count, recurs(), Increment::later>(t, part);
    if (t.how == Increment::set) return take_step<Dim, count, recurs(), Increment::set>(t, part);
    if constexpr (recurs()) {  // not the first
      if (t.how == Increment::set_two) return take_step<Dim, count, true, Increment::set_two>(t, part);
      if (t.how == Increment::add) return take_step<Dim, count, true, Increment::add>(t, part);
      take_step<Dim, count, true, Increment::add_two>(t, part);
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
  residual_ = work_.part(0, 1);
  before_ = work_.part(1, 1);
  direction_ = work_.part(2, 1);
  if (options.memory > 0) memory_ = FieldBlock(grid, options.memory);
  if (options.memory == 0 && options.multigrid) own_scratch_ = FieldBlock(grid, 1);
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
  return work_.bytes() + memory_.bytes() + own_scratch_.bytes() + (multigrid_ ? multigrid_->bytes() : 0);
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
  left_ = recurs_ = false;
  if (memory_) {
    if (!ghosts_of_memory_) PetscCall(update_ghosts(memory_, 1));
    ghosts_of_memory_ = true;
    directions_.clear();
    for (int f = 0; f < memory_.count(); ++f) directions_.push_back(memory_[(newest_ + f) % memory_.count()]);
    newest_ = (newest_ + memory_.count() - 1) % memory_.count();  // the oldest: it will be
    PetscCall(sweep(divergence[0], false, dt, increment, &done));
  } else {
    for (const Segment &s : grid_->rows())
      std::copy_n(divergence[0].row(s.j, s.k), s.size(), residual_[0].row(s.j, s.k));
    PetscCall(update_ghosts(residual_, Multigrid::halo));
  }
  FieldBlock correction = work_.part(3, 1), scratch;  // multigrid may swap them
  if (multigrid_) scratch = memory_ ? memory_.part(newest_, 1) : own_scratch_.part(0, 1);
  for (int s = 1; s <= options_.sweeps_max && !done; ++s) {
    if (multigrid_) {
      PetscCall(multigrid_->apply(residual_, correction, scratch));
      fill_wall_ghosts_even(*grid_, at_centre, correction[0], 1);
      scope.flops(multigrid_->flops());
    }
    directions_.assign(1, multigrid_ ? correction[0] : residual_[0]);
    PetscCall(sweep(residual_[0], s == options_.sweeps_max, dt, increment, &done));
    ++sweeps_;
  }
  if (memory_) memory_.part(newest_, 1).copy_from(increment);
  PetscFunctionReturn(0);
}

PetscErrorCode AcmSweepSolver::sweep(ConstView residual, bool last, double dt, FieldBlock &increment, bool *done) {
  PetscFunctionBeginUser;
  const int stencils = static_cast<int>(directions_.size());
  const SweepTask task{
      grid_, directions_.data(), stencils, recurs_, residual, residual_before_, grid_->inverse_squares()};
  SweepMinimum minimum;
  double mean = 0;
  PetscCall(find_minimum(task, &minimum, &mean));
  residual_rms_ = std::sqrt(minimum.square / grid_->cell_count());
  *done = last || !(residual_rms_ > target_);  // NaN is done
  const int directions = stencils + recurs_;
  const double laplacians = stencils * (4 * grid_->dimension() + 1) + recurs_;
  PetscCall(PetscLogFlops(grid_->owned_count() * (laplacians + 2 * directions + 2 * sum_count(directions) + 2)));
  const bool left = left_;
  const Increment how = !left && !*done ? Increment::later
                        : first_        ? (left ? Increment::set_two : Increment::set)
                                        : (left ? Increment::add_two : Increment::add);
  left_ = how == Increment::later;
  if (!left_) first_ = false;
  const StepTask step{task,          minimum.coefficient, minimum.coefficient[0] * mean, 1 / dt, how, *done, before_[0],
                      direction_[0], increment[0]};
  in_row_parts(*grid_, [&](const RowPart &part) {
    (grid_->dimension() == 2 ? take_step_2d : take_step_3d)(step, part.with_ghosts(*grid_));
  });
  if (*done) PetscFunctionReturn(0);
  PetscCall(PetscLogFlops(grid_->owned_count() * (laplacians + 2 * directions)));
  residual_.swap(before_);
  residual_before_ = residual;
  recurs_ = true;
  PetscCall(exchange_->update_wrapped(residual_, Multigrid::halo));
  fill_wall_ghosts_even(*grid_, at_centre, residual_[0], 1);
  PetscFunctionReturn(0);
}

}  // namespace eulastic
