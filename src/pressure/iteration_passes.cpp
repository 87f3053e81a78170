#include "pressure/iteration_passes.hpp"

#include "grid/blocks.hpp"
#include "kernels/momentum.hpp"
#include "kernels/stencils.hpp"
#include "pressure/row_sums.hpp"

#include <algorithm>
#include <type_traits>

namespace eulastic {
namespace {

constexpr int most = LeastSquaresSums::most;

// Number of sums over the owned cells, in the order D D, q_0, (D L_i), (L_i L_j, j <= i).
constexpr int sum_count(int directions) { return 2 + directions + directions * (directions + 1) / 2; }

// Calls work(count, with_previous) with both as constants. The previous direction is combined with one stencil.
template <class Work>
EULASTIC_INLINE void for_directions(int stencils, bool with_previous, Work work) {
  static_assert(most == 4, "one case for every number of directions");
  using No = std::false_type;
  if (with_previous) return work(std::integral_constant<int, 1>{}, std::true_type{});
  if (stencils == 1) return work(std::integral_constant<int, 1>{}, No{});
  if (stencils == 2) return work(std::integral_constant<int, 2>{}, No{});
  if (stencils == 3) return work(std::integral_constant<int, 3>{}, No{});
  work(std::integral_constant<int, 4>{}, No{});
}

template <int Dim, int Stencils, bool WithPrevious>
EULASTIC_INLINE void add_sums(const IterationTask &t, const RowPart &part, char *all_summed, ExactSums &sums) {
  constexpr int directions = Stencils + WithPrevious;
  const Int3 n = t.domain->cells();
  const std::int64_t begin = t.domain->layout().begin[0];
  const InverseSquares h = t.domain->inverse_squares();
  const std::ptrdiff_t sy = t.residual.sy, sz = t.residual.sz;
  for_rows_in_blocks(part, [&](int j, int k) EULASTIC_BODY {
    char &summed = all_summed[j + std::size_t(n[1]) * k];
    if (summed) return;
    summed = 1;
    const double *D = t.residual.row(j, k), *before = WithPrevious ? t.before.row(j, k) : nullptr, *q[Stencils];
    if (Dim == 3) prefetch(D + sz, n[0]);
    if (Dim == 3 && WithPrevious) prefetch(before + sz, n[0]);
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
EULASTIC_INLINE void add_sums(const IterationTask &t, const RowPart &part, char *summed, ExactSums &sums) {
  for_directions(t.stencils, t.with_previous, [&](auto stencils, auto with_previous) EULASTIC_BODY {
    add_sums<Dim, stencils(), with_previous()>(t, part, summed, sums);
  });
}

EULASTIC_CLONES void add_sums_2d(const IterationTask &t, const RowPart &part, char *summed, ExactSums &sums) {
  add_sums<2>(t, part, summed, sums);
}
EULASTIC_CLONES void add_sums_3d(const IterationTask &t, const RowPart &part, char *summed, ExactSums &sums) {
  add_sums<3>(t, part, summed, sums);
}

template <int Dim, int Stencils, bool WithPrevious, Increment How>
EULASTIC_INLINE void update_fields(const UpdateTask &t, const RowPart &part) {
  constexpr bool adds = How == Increment::add || How == Increment::add_two,
                 two = How == Increment::set_two || How == Increment::add_two;
  const Int3 n = t.domain->cells();
  const InverseSquares h = t.domain->inverse_squares();
  const HaloOverlap sides(*t.domain);
  const double shift = t.shift, scale = t.scale;
  const std::ptrdiff_t sy = t.increment.sy, sz = t.increment.sz;
  double c[Stencils + WithPrevious];
  std::copy_n(t.coefficient, Stencils + WithPrevious, c);
  const auto row = [&](int j, int k) EULASTIC_BODY {
    const double *q[Stencils];
    for (int f = 0; f < Stencils; ++f) q[f] = t.q[f].row(j, k);
    double *increment = t.increment.row(j, k), *direction = t.direction.row(j, k);
    const auto move = [=](int i) EULASTIC_BODY {
      double d = -shift;
#pragma GCC unroll 4
      for (int f = 0; f < Stencils; ++f) d = kernels::fma(c[f], q[f][i], d);
      if (WithPrevious) d = kernels::fma(c[Stencils], direction[i], d);
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
    const double *D = t.residual.row(j, k), *before = WithPrevious ? t.before.row(j, k) : nullptr;
    double *out = t.new_residual.row(j, k);
    for (const int i : {-1, n[0]}) direction[i] = move(i);
#pragma omp simd
    for (int i = 0; i < n[0]; ++i) {
      direction[i] = move(i);
      double rest = D[i];
#pragma GCC unroll 4
      for (int f = 0; f < Stencils; ++f) rest = kernels::fma(-c[f], kernels::laplacian<Dim>(q[f] + i, sy, sz, h), rest);
      if (WithPrevious) rest = kernels::fma(-c[Stencils], before[i] - D[i], rest);
      out[i] = rest;
    }
    sides.wrap(out);
  };
  for_rows_in_blocks(part.with_ghosts(*t.domain), row, [&](int j_begin, int j_end, int k) EULASTIC_BODY {
    if (Dim == 3 && t.after && k - 1 > part.k_begin) t.after(part.number, j_begin - 1, j_end - 1, k - 1);
  });
}

template <int Dim>
EULASTIC_INLINE void update_fields(const UpdateTask &t, const RowPart &part) {
  for_directions(t.stencils, t.with_previous, [&](auto stencils, auto with_previous) EULASTIC_BODY {
    constexpr int count = stencils();
    if (t.how == Increment::later) return update_fields<Dim, count, with_previous(), Increment::later>(t, part);
    if (t.how == Increment::set) return update_fields<Dim, count, with_previous(), Increment::set>(t, part);
    if constexpr (with_previous()) {  // not the first iteration
      if (t.how == Increment::set_two) return update_fields<Dim, count, true, Increment::set_two>(t, part);
      if (t.how == Increment::add) return update_fields<Dim, count, true, Increment::add>(t, part);
      update_fields<Dim, count, true, Increment::add_two>(t, part);
    }
  });
}

EULASTIC_CLONES void update_fields_2d(const UpdateTask &t, const RowPart &part) { update_fields<2>(t, part); }
EULASTIC_CLONES void update_fields_3d(const UpdateTask &t, const RowPart &part) { update_fields<3>(t, part); }

}  // namespace

void IterationSums::start(const Domain &domain, int directions) {
  sums_.assign(row_parts(domain), ExactSums(sum_count(directions)));
  summed_.assign(std::size_t(domain.cells()[1]) * domain.cells()[2], 0);
}

void IterationSums::add_inner(const IterationTask &task, int thread, int j_begin, int j_end, int k) {
  const Int3 &n = task.domain->cells();
  if (k < 1 || k >= n[2] - 1) return;
  add_sums_3d(task, {thread, std::max(j_begin, 1), std::min(j_end, n[1] - 1), k, k + 1, false, false}, summed_.data(),
              sums_[thread]);
}

PetscErrorCode IterationSums::find_minimum(const IterationTask &task, LeastSquaresSolution *minimum, double *mean) {
  PetscFunctionBeginUser;
  const int count = task.directions();
  in_row_parts(*task.domain, [&](const RowPart &part) {
    (task.domain->dimension() == 2 ? add_sums_2d : add_sums_3d)(task, part, summed_.data(), sums_[part.number]);
  });
  double total[sum_count(most)];
  PetscCall(reduce_parts(task.domain->comm(), sums_, total));
  LeastSquaresSums sums;
  sums.directions = count;
  int s = 0;
  sums.square = total[s++];
  *mean = total[s++] / task.domain->domain_cell_count();
  if (task.domain->any_open()) *mean = 0;  // the mean is determined by the boundary
  for (int f = 0; f < count; ++f) sums.with[f] = total[s++];
  for (int f = 0; f < count; ++f)
    for (int g = 0; g <= f; ++g) sums.product[f][g] = total[s++];
  const int d = count - 1;
  if (task.with_previous && sums.product[d][d] < 1e-12 * sums.square) {
    sums.with[d] = 0;
    std::fill_n(sums.product[d], count, 0);
  }
  *minimum = minimise(sums);
  PetscFunctionReturn(0);
}

void update_fields(const UpdateTask &task) {
  in_row_parts(*task.domain, [&](const RowPart &part) {
    (task.domain->dimension() == 2 ? update_fields_2d : update_fields_3d)(task, part);
  });
}

}  // namespace eulastic
