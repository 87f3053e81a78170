#include "pressure/multigrid.hpp"

#include "grid/threads.hpp"
#include "grid/row_scratch.hpp"

#include <algorithm>

namespace eulastic {

// Factors of the relaxations' steps, times MultigridLevel::step(). The eigenvalues of -lap step() end at 2; the steps
// together are small between 1/3 (1/2 in 2-D), where the coarse grid stops helping, and 2. Coarse levels cost little.
struct Multigrid::Relaxations {
  double before;
  std::vector<double> after;
};

namespace {

const Multigrid::Relaxations on_finest{0.7, {0.57, 1.5}}, on_coarse{0.8, {0.54, 0.8, 1.6}};
constexpr double gathered_cells = 4096;  // from here on messages cost more than cells

template <int Dim>
EULASTIC_INLINE void relax_rows(const MultigridLevel &level, const RowPart &part, double factor, ConstView q,
                                ConstView r, View out) {
  const int n = level.grid().owned()[0];
  for (int k = part.k_begin; k < part.k_end; ++k)
    for (int j = part.j_begin; j < part.j_end; ++j)
      kernels::relax<Dim>({0, n, j, k}, q, r, level.coefficients(j, k), factor, out);
}

EULASTIC_CLONES void relax_2d(const MultigridLevel &l, const RowPart &part, double factor, ConstView q, ConstView r,
                              View out) {
  relax_rows<2>(l, part, factor, q, r, out);
}
EULASTIC_CLONES void relax_3d(const MultigridLevel &l, const RowPart &part, double factor, ConstView q, ConstView r,
                              View out) {
  relax_rows<3>(l, part, factor, q, r, out);
}

template <int Dim>
EULASTIC_INLINE void restrict_rows(const MultigridLevel &fine, double factor, ConstView r, int n, const RowPart &part,
                                   View out, double *sum) {
  const auto &[x, y, z] = fine.lines;
  // One fine cell more than there are children: a last cell without a partner has the weight 0 for it.
  const int begin = x.first, end = x.first + x.stride * n + (x.weight[2].back() > 0);
  for (int k = part.k_begin; k < part.k_end; ++k)
    for (int j = part.j_begin; j < part.j_end; ++j) {
      for (int i = begin; i < end; ++i) sum[i] = 0;
      for (int c = 0; c < 3; ++c)
        for (int b = 0; b < 3; ++b) {
          const double weight = z.weight[c][k] * y.weight[b][j];
          const int fine_j = y.first + y.stride * j + b, fine_k = z.first + z.stride * k + c;
          const int last = x.weight[1].back() > 0 || x.stride == 1 ? end : end - 1;
          if (weight > 0)
            kernels::add_relaxed_residual<Dim>({begin, last, fine_j, fine_k}, r, fine.coefficients(fine_j, fine_k),
                                               factor, weight, sum);
        }
      double *coarse = out.row(j, k);
      if (x.stride == 1) {
        for (int i = 0; i < n; ++i) coarse[i] = sum[i];
        continue;
      }
      kernels::join_pairs(n, sum + begin, x.weight[0].data(), x.weight[1].data(), coarse);
      if (x.weight[2].back() > 0) coarse[n - 1] += x.weight[2].back() * sum[end - 1];
    }
}

EULASTIC_CLONES void restrict_2d(const MultigridLevel &f, double a, ConstView r, int n, const RowPart &part, View out,
                                 double *sum) {
  restrict_rows<2>(f, a, r, n, part, out, sum);
}
EULASTIC_CLONES void restrict_3d(const MultigridLevel &f, double a, ConstView r, int n, const RowPart &part, View out,
                                 double *sum) {
  restrict_rows<3>(f, a, r, n, part, out, sum);
}

EULASTIC_INLINE void blend_along_y(const LineTransfer &y, int j, ConstView e, int k, int begin, int end, double *out) {
  kernels::blend(begin, end, e.row(y.parent[j], k), e.row(y.neighbour[j], k), y.share[j], out);
}

// out = factor r + interpolated e; e has `coarse_cells` owned cells in x. `scratch`: three rows.
EULASTIC_CLONES void prolong_rows(const MultigridLevel &fine, const RowPart &part, int coarse_cells, double factor,
                                  ConstView r, ConstView e, View out, const RowScratch &scratch) {
  const Int3 n = fine.grid().owned();
  const auto &[x, y, z] = fine.lines;
  const int begin = -1, end = coarse_cells + 1;
  double *near = scratch.row(0), *far = scratch.row(1), *line = scratch.row(2);
  for (int k = part.k_begin; k < part.k_end; ++k)
    for (int j = part.j_begin; j < part.j_end; ++j) {
      blend_along_y(y, j, e, z.parent[k], begin, end, near);
      if (z.share[k] > 0) {
        blend_along_y(y, j, e, z.neighbour[k], begin, end, far);
        kernels::blend(begin, end, near, far, z.share[k], near);
      }
      const double *fine_line = near;
      if (x.stride == 2) {
        kernels::split_pairs(x.first > 0 ? -1 : 0, coarse_cells, near, x.low(), x.high(), line + x.first);
        // The last cell may have one child or three.
        for (int i = std::max(0, n[0] - 3); i < n[0]; ++i)
          line[i] = kernels::fma(x.share[i], near[x.neighbour[i]] - near[x.parent[i]], near[x.parent[i]]);
        fine_line = line;
      }
      const double *rhs = r.row(j, k);
      double *to = out.row(j, k);
#pragma omp simd
      for (int i = 0; i < n[0]; ++i) to[i] = kernels::fma(factor, rhs[i], fine_line[i]);
    }
}

// Calls f(values of owned row, its place in x-fastest order) on every owned row.
template <class F>
void each_row(const Int3 &n, const F &f) {
  for (int k = 0; k < n[2]; ++k)
    for (int j = 0; j < n[1]; ++j) f(j, k, n[0] * (j + std::ptrdiff_t(n[1]) * k));
}

}  // namespace

// By cells: the finest level may also be the one that every rank holds.
const Multigrid::Relaxations &Multigrid::relaxations(const MultigridLevel &level) const {
  return level.grid().cells() == levels_[0]->grid().cells() ? on_finest : on_coarse;
}

PetscErrorCode Multigrid::create(const Grid &grid) {
  PetscFunctionBeginUser;
  MultigridLevel::Widths equal;
  for (int d = 0; d < 3; ++d) equal[d].assign(grid.cells()[d], 1.0);
  levels_.clear();
  levels_.push_back(std::make_unique<MultigridLevel>(grid.coarse(grid.cells(), false), equal, grid.spacing()));
  flops_ = 0;
  while (!levels_.back()->single_cell()) {
    MultigridLevel &fine = *levels_.back();
    const double owned = fine.grid().owned_count(), dim = fine.grid().dimension();
    Level next = fine.coarser();
    if (fine.grid().ranks() > 1 && (fine.grid().cell_count() <= gathered_cells || !next->well_shared())) {
      next = fine.everywhere();
    } else {
      for (int d = 0; d < 3; ++d) fine.lines[d] = fine.transfer(*next, d);
      flops_ +=
          owned * ((relaxations(fine).after.size() + 1) * (kernels::line_laplacian_flops_per_direction * dim + 3) + 6);
    }
    next->rhs = FieldBlock(next->grid(), 1);
    next->solution = FieldBlock(next->grid(), 1);
    next->scratch = FieldBlock(next->grid(), 1);
    levels_.push_back(std::move(next));
  }
  PetscFunctionReturn(0);
}

std::size_t Multigrid::bytes() const {
  std::size_t sum = 0;
  for (const Level &level : levels_) sum += level->rhs.bytes() + level->solution.bytes() + level->scratch.bytes();
  return sum;
}

PetscErrorCode Multigrid::apply(const FieldBlock &rhs, FieldBlock &solution, FieldBlock &scratch) {
  PetscFunctionBeginUser;
  PetscCall(cycle(0, rhs, solution, scratch));
  PetscFunctionReturn(0);
}

PetscErrorCode Multigrid::cycle(std::size_t l, const FieldBlock &rhs, FieldBlock &solution, FieldBlock &scratch) {
  PetscFunctionBeginUser;
  MultigridLevel &level = *levels_[l];
  if (level.single_cell()) PetscFunctionReturn(0);  // defined up to a constant: 0, for ever
  MultigridLevel &next = *levels_[l + 1];
  if (next.grid().ranks() < level.grid().ranks()) {
    PetscCall(gather(level, next, rhs));
    PetscCall(next.exchange().update(next.rhs, halo));
    PetscCall(cycle(l + 1, next.rhs, next.solution, next.scratch));
    take_part(level, next, solution);
    PetscCall(level.exchange().update(solution, 1));
    PetscFunctionReturn(0);
  }
  restrict_residual(level, rhs, next);
  PetscCall(next.exchange().update(next.rhs, halo));
  PetscCall(cycle(l + 1, next.rhs, next.solution, next.scratch));
  prolong(level, rhs, next, solution);
  PetscCall(level.exchange().update(solution, 1));
  for (const double after : relaxations(level).after) {
    in_row_parts(level.grid(), [&](const RowPart &part) {
      const double factor = after * level.step();
      (level.grid().dimension() == 2 ? relax_2d : relax_3d)(level, part, factor, solution[0], rhs[0], scratch[0]);
    });
    solution.swap(scratch);
    PetscCall(level.exchange().update(solution, 1));
  }
  PetscFunctionReturn(0);
}

void Multigrid::restrict_residual(const MultigridLevel &fine, const FieldBlock &rhs, MultigridLevel &coarse) {
  const double factor = relaxations(fine).before * fine.step();
  const int parts = row_parts(fine.grid()), n = coarse.grid().owned()[0];
  in_parallel(parts, parts, [&](int part) {
    const RowScratch sum(fine.grid(), 1);
    (fine.grid().dimension() == 2 ? restrict_2d : restrict_3d)(
        fine, factor, rhs[0], n, row_part(coarse.grid(), part, parts), coarse.rhs[0], sum.row(0));
  });
}

void Multigrid::prolong(const MultigridLevel &fine, const FieldBlock &rhs, const MultigridLevel &coarse,
                        FieldBlock &solution) {
  const double factor = relaxations(fine).before * fine.step();
  in_row_parts(fine.grid(), [&](const RowPart &part) {
    const RowScratch scratch(fine.grid(), 3);
    prolong_rows(fine, part, coarse.grid().owned()[0], factor, rhs[0], coarse.solution[0], solution[0], scratch);
  });
}

PetscErrorCode Multigrid::gather(MultigridLevel &level, MultigridLevel &whole, const FieldBlock &rhs) {
  PetscFunctionBeginUser;
  const Grid &grid = level.grid();
  if (counts_.empty()) {
    for (int rank = 0; rank < grid.ranks(); ++rank) {
      const Int3 n = grid.layout_of(rank).cells;
      displacements_.push_back(rank ? displacements_.back() + counts_.back() : 0);
      counts_.push_back(n[0] * n[1] * n[2]);
    }
    packed_.resize(counts_[grid.rank()]);
    gathered_.resize(displacements_.back() + counts_.back());
  }
  const Int3 own = grid.owned();
  each_row(own, [&](int j, int k, std::ptrdiff_t at) { std::copy_n(rhs[0].row(j, k), own[0], packed_.data() + at); });
  PetscCallMPI(MPI_Allgatherv(packed_.data(), counts_[grid.rank()], MPI_DOUBLE, gathered_.data(), counts_.data(),
                              displacements_.data(), MPI_DOUBLE, grid.comm()));
  for (int rank = 0; rank < grid.ranks(); ++rank) {
    const Layout theirs = grid.layout_of(rank);
    const double *from = gathered_.data() + displacements_[rank];
    each_row(theirs.cells, [&](int j, int k, std::ptrdiff_t at) {
      std::copy_n(from + at, theirs.cells[0],
                  whole.rhs[0].row(theirs.begin[1] + j, theirs.begin[2] + k) + theirs.begin[0]);
    });
  }
  PetscFunctionReturn(0);
}

void Multigrid::take_part(const MultigridLevel &level, const MultigridLevel &whole, FieldBlock &solution) const {
  const Layout &own = level.grid().layout();
  each_row(own.cells, [&](int j, int k, std::ptrdiff_t) {
    std::copy_n(whole.solution[0].row(own.begin[1] + j, own.begin[2] + k) + own.begin[0], own.cells[0],
                solution[0].row(j, k));
  });
}

}  // namespace eulastic
