#include "pressure/sweep_passes.hpp"

#include "grid/blocks.hpp"
#include "kernels/momentum.hpp"
#include "kernels/stencils.hpp"
#include "pressure/row_sums.hpp"

#include <algorithm>
#include <type_traits>

namespace eulastic {
namespace {

constexpr int most = SweepSums::most;

// Sums over the owned cells, in the order D D, q_0, (D L_i), (L_i L_j, j <= i).
constexpr int sum_count(int directions) { return 2 + directions + directions * (directions + 1) / 2; }

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

template <int Dim, int Stencils, bool Recurs>
EULASTIC_INLINE void add_sums(const SweepTask &t, const RowPart &part, char *all_summed, ExactSums &sums) {
  constexpr int directions = Stencils + Recurs;
  const Int3 n = t.domain->cells();
  const std::int64_t begin = t.domain->layout().begin[0];
  const InverseSquares h = t.domain->inverse_squares();
  const std::ptrdiff_t sy = t.residual.sy, sz = t.residual.sz;
  for_rows_in_blocks(part, [&](int j, int k) EULASTIC_BODY {
    char &summed = all_summed[j + std::size_t(n[1]) * k];
    if (summed) return;
    summed = 1;
    const double *D = t.residual.row(j, k), *before = Recurs ? t.before.row(j, k) : nullptr, *q[Stencils];
    if (Dim == 3) prefetch(D + sz, n[0]);
    if (Dim == 3 && Recurs) prefetch(before + sz, n[0]);
    for (int f = 0; f < Stencils; ++f) {
      q[f] = t.q[f].row(j, k);
      if (Dim == 3) prefetch(q[f] + 2 * sz, n[0]);
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
EULASTIC_INLINE void add_sums(const SweepTask &t, const RowPart &part, char *summed, ExactSums &sums) {
  for_directions(t.stencils, t.recurs, [&](auto stencils, auto recurs) EULASTIC_BODY {
    add_sums<Dim, stencils(), recurs()>(t, part, summed, sums);
  });
}

EULASTIC_CLONES void add_sums_2d(const SweepTask &t, const RowPart &part, char *summed, ExactSums &sums) {
  add_sums<2>(t, part, summed, sums);
}
EULASTIC_CLONES void add_sums_3d(const SweepTask &t, const RowPart &part, char *summed, ExactSums &sums) {
  add_sums<3>(t, part, summed, sums);
}

template <int Dim, int Stencils, bool Recurs, Increment How>
EULASTIC_INLINE void take_step(const StepTask &t, const RowPart &part) {
  constexpr bool adds = How == Increment::add || How == Increment::add_two,
                 two = How == Increment::set_two || How == Increment::add_two;
  const Int3 n = t.domain->cells();
  const InverseSquares h = t.domain->inverse_squares();
  const Sides sides(*t.domain);
  const double shift = t.shift, scale = t.scale;
  const std::ptrdiff_t sy = t.increment.sy, sz = t.increment.sz;
  double c[Stencils + Recurs];
  std::copy_n(t.coefficient, Stencils + Recurs, c);
  const auto row = [&](int j, int k) EULASTIC_BODY {
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
    sides.wrap(out);
  };
  for_rows_in_blocks(part.with_ghosts(*t.domain), row, [&](int j_begin, int j_end, int k) EULASTIC_BODY {
    if (Dim == 3 && t.after && k - 1 > part.k_begin) t.after(part.number, j_begin - 1, j_end - 1, k - 1);
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

void RowSums::start(const Domain &domain, int directions) {
  sums_.assign(row_parts(domain), ExactSums(sum_count(directions)));
  summed_.assign(std::size_t(domain.cells()[1]) * domain.cells()[2], 0);
}

void RowSums::add_inner(const SweepTask &task, int thread, int j_begin, int j_end, int k) {
  const Int3 &n = task.domain->cells();
  if (k < 1 || k >= n[2] - 1) return;
  add_sums_3d(task, {thread, std::max(j_begin, 1), std::min(j_end, n[1] - 1), k, k + 1, false, false}, summed_.data(),
              sums_[thread]);
}

PetscErrorCode RowSums::find_minimum(const SweepTask &task, SweepMinimum *minimum, double *mean) {
  PetscFunctionBeginUser;
  const int count = task.directions();
  in_row_parts(*task.domain, [&](const RowPart &part) {
    (task.domain->dimension() == 2 ? add_sums_2d : add_sums_3d)(task, part, summed_.data(), sums_[part.number]);
  });
  double total[sum_count(most)];
  PetscCall(reduce_parts(task.domain->comm(), sums_, total));
  SweepSums sums;
  sums.directions = count;
  int s = 0;
  sums.square = total[s++];
  *mean = total[s++] / task.domain->domain_cell_count();
  if (task.domain->any_open()) *mean = 0;  // is not free
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

void take_step(const StepTask &task) {
  in_row_parts(*task.domain,
               [&](const RowPart &part) { (task.domain->dimension() == 2 ? take_step_2d : take_step_3d)(task, part); });
}

}  // namespace eulastic
