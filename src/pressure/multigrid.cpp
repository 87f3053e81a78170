#include "pressure/multigrid.hpp"

#include "base/one_line.hpp"
#include "grid/blocks.hpp"
#include "grid/row_scratch.hpp"
#include "kernels/stencils.hpp"

#include <algorithm>

namespace eulastic {

// Steps of the relaxations in units of MultigridLevel::step(). The eigenvalues of -lap step() are at most 2; the
// combined amplification is small from 1/3 (2-D: 1/2), where the coarse grid becomes ineffective, to 2. Coarse levels
// have more relaxations, because these cost little.
struct Multigrid::Relaxations {
  double before;
  std::vector<double> after;
};

namespace {

const Multigrid::Relaxations on_finest{0.7, {0.57, 1.5}}, on_coarse{0.8, {0.54, 0.8, 1.6}};

std::unique_ptr<MultigridLevel> finest(const Domain &domain, const ZeroSides &zero) {
  MultigridLevel::Widths equal;
  for (int d = 0; d < 3; ++d) equal[d].assign(domain.domain_cells()[d], 1.0);
  return std::make_unique<MultigridLevel>(Partition(domain, zero), equal, domain.spacing());
}

// Whether two levels have the same cells, on different ranks.
bool same_cells(const MultigridLevel &level, const MultigridLevel &next) {
  return level.box().domain_cells() == next.box().domain_cells();
}

// Restricts the residual after one relaxation from zero; `sum` is scratch.
template <int Dim>
EULASTIC_INLINE void restrict_rows(const MultigridLevel &fine, double factor, ConstView r, int n, const RowPart &part,
                                   View out, double *sum) {
  const auto &[x, y, z] = fine.lines;
  // A last cell without a partner is processed with a further fine cell of weight 0.
  const int begin = x.first, end = x.first + x.stride * n + (x.weight[2].back() > 0);
  for_rows_in_blocks(part, [&](int j, int k) EULASTIC_BODY {
    const int fine_j = y.first + y.stride * j, fine_k = z.first + z.stride * k;
    const int last = x.weight[1].back() > 0 || x.stride == 1 ? end : end - 1;
    if (Dim == 3)  // prefetch the next plane
      for (int c = 0; c < z.stride; ++c)
        for (int b = 0; b < y.stride; ++b) prefetch(r.row(fine_j + b, fine_k + 1 + z.stride + c), end);
    for (int i = begin; i < end; ++i) sum[i] = 0;
    for (int c = 0; c < 3; ++c)
      for (int b = 0; b < 3; b += 2) {  // the first two rows of children together, then the third one
        const Segment row{begin, last, fine_j + b, fine_k + c};
        const double plane = z.weight[c][k], weight[2] = {plane * y.weight[b][j], b == 0 ? plane * y.weight[1][j] : 0};
        if (!(weight[0] > 0)) continue;
        const kernels::LineCoefficients near[2] = {fine.coefficients(row.j, row.k),
                                                   fine.coefficients(row.j + 1, row.k)};
        if (weight[1] > 0)
          kernels::add_relaxed_residual<Dim, 2>(row, r, near, weight, factor, sum);
        else
          kernels::add_relaxed_residual<Dim, 1>(row, r, near, weight, factor, sum);
      }
    double *coarse = out.row(j, k);
    if (x.stride == 1) {
      for (int i = 0; i < n; ++i) coarse[i] = sum[i];
      return;
    }
    kernels::restrict_pairs(n, sum + begin, x.weight[0].data(), x.weight[1].data(), coarse);
    if (x.weight[2].back() > 0) coarse[n - 1] += x.weight[2].back() * sum[end - 1];
  });
}

EULASTIC_CLONES void restrict_2d(const MultigridLevel &f, double a, ConstView r, int n, const RowPart &part, View out,
                                 double *sum) {
  restrict_rows<2>(f, a, r, n, part, out, sum);
}
EULASTIC_CLONES void restrict_3d(const MultigridLevel &f, double a, ConstView r, int n, const RowPart &part, View out,
                                 double *sum) {
  restrict_rows<3>(f, a, r, n, part, out, sum);
}

// Smoothing stages that share a pass over memory. Stage s reads fields[s % 2] and writes the other field. The first
// stage of a level interpolates.
struct Pass {
  const HaloOverlap *sides;
  const MultigridLevel *fine;
  const MultigridLevel *coarse;  // level to interpolate from; null: all stages relax
  const double *factor;          // of every stage
  ConstView rhs;
  View fields[2];
  int depth;
  int open_end;                          // first ghost in x behind a high open boundary; -1: none
  const Multigrid::RowsDone *rows_done;  // called as a further stage
};

// out = factor r + interpolated e; e has `coarse_cells` owned cells in x.
EULASTIC_INLINE void prolong_row(const MultigridLevel &fine, const Segment &row, int coarse_cells, double factor,
                                 ConstView r, ConstView e, View out) {
  const LineTransfer &x = fine.lines[0], &y = fine.lines[1], &z = fine.lines[2];
  const int j = row.j, k = row.k;
  const double *rhs = r.row(j, k);
  double *to = out.row(j, k);
  const kernels::CoarseRows corners{{e.row(y.parent[j], z.parent[k]), e.row(y.neighbour[j], z.parent[k]),
                                     e.row(y.parent[j], z.neighbour[k]), e.row(y.neighbour[j], z.neighbour[k])},
                                    y.share[j],
                                    z.share[k]};
  if (x.stride == 1) return kernels::add_interpolated(row.i_begin, row.i_end, corners, factor, rhs, to);
  const int first = x.first > 0 ? -1 : 0, regular = x.first + 2 * (coarse_cells - 1);
  kernels::add_interpolated_pairs(first, coarse_cells, corners, x.low(), x.high(), factor, rhs + x.first, to + x.first);
  const auto add = [&](int i) {
    const double near = corners.at(x.parent[i]);
    to[i] = kernels::fma(factor, rhs[i], kernels::fma(x.share[i], corners.at(x.neighbour[i]) - near, near));
  };
  for (int i = row.i_begin; i < 0; ++i) add(i);
  if (row.i_end == regular + 2) return;
  for (int i = std::max(0, regular - 1); i < row.i_end; ++i) add(i);  // the last cell may have one child or three
}

template <int Dim>
EULASTIC_INLINE void stages_of_task(const Pass &pass, const StagePass &order, const StagePass::Task &task) {
  order.for_rows<Dim>(task, [&](int s, Segment row, int j_end) EULASTIC_BODY {
    const View q = pass.fields[s % 2], out = pass.fields[1 - s % 2];
    if (s == pass.depth) return (*pass.rows_done)(q, task.thread, row.j, j_end, row.k);
    for (; row.j < j_end; ++row.j) {
      if (Dim == 3 && s == 0)
        for (const double *values :
             {pass.rhs.row(row.j, row.k + 1), ConstView(q).row(row.j, row.k + 1), ConstView(out).row(row.j, row.k + 1)})
          prefetch(values, row.i_end);
      if (s == 0 && pass.coarse)
        prolong_row(*pass.fine, row, pass.coarse->box().cells()[0], pass.factor[0], pass.rhs, pass.coarse->solution[0],
                    out);
      else
        kernels::relax<Dim>(row, q, pass.rhs, pass.fine->coefficients(row.j, row.k), pass.factor[s], out);
      pass.sides->wrap(out.row(row.j, row.k));  // long before it is read
      if (s == 0 && pass.open_end >= 0)
        out.row(row.j, row.k)[pass.open_end] = 0;  // pairs may reach behind the boundary
    }
  });
}

EULASTIC_CLONES void stages_2d(const Pass &pass, const StagePass &order, const StagePass::Task &task) {
  stages_of_task<2>(pass, order, task);
}
EULASTIC_CLONES void stages_3d(const Pass &pass, const StagePass &order, const StagePass::Task &task) {
  stages_of_task<3>(pass, order, task);
}

}  // namespace

// The number of cells decides, since the finest level may appear a second time on other ranks.
const Multigrid::Relaxations &Multigrid::relaxations(const MultigridLevel &level) const {
  return level.box().domain_cells() == levels_[0]->box().domain_cells() ? on_finest : on_coarse;
}

std::vector<Multigrid::Level> Multigrid::plan(const Domain &domain, const ZeroSides &zero) {
  std::vector<Level> levels;
  levels.push_back(finest(domain, zero));
  while (!levels.back()->single_cell()) levels.push_back(levels.back()->next());
  return levels;
}

std::string Multigrid::shares(const Domain &domain) {
  const std::vector<Level> levels = plan(domain);
  double joined = 0, gathered = 0;  // cells of the largest level on fewer ranks, and of the one on every rank
  for (std::size_t l = 1; l < levels.size(); ++l) {
    if (!same_cells(*levels[l - 1], *levels[l])) continue;
    double &cells = levels[l]->partition().ranks() == 1 ? gathered : joined;
    cells = std::max(cells, levels[l]->box().domain_cell_count());
  }
  const std::string fewer = joined > 0 ? print(", on fewer ranks from the level of %.0f cells on", joined) : "";
  return print("%zu levels%s; the level of %.0f cells goes to every rank, %.4g MB each time", levels.size(),
               fewer.c_str(), gathered, 1e-6 * sizeof(double) * gathered);
}

PetscErrorCode Multigrid::create(const Domain &domain, const ZeroSides &zero) {
  PetscFunctionBeginUser;
  levels_ = plan(domain, zero);
  flops_ = 0;
  for (std::size_t l = 0; l + 1 < levels_.size(); ++l) {
    MultigridLevel &fine = *levels_[l], &next = *levels_[l + 1];
    const double owned = fine.box().cell_count(), dim = fine.box().dimension();
    if (same_cells(fine, next)) {
      fine.agglomeration = std::make_unique<Agglomeration>();
      PetscCall(fine.agglomeration->create(fine.partition(), next.partition()));
    } else {
      for (int d = 0; d < 3; ++d) fine.lines[d] = fine.transfer(next, d);
      flops_ +=
          owned * ((relaxations(fine).after.size() + 1) * (kernels::line_laplacian_flops_per_direction * dim + 3) + 6);
    }
    // On coarse levels messages cost more than redundant computation.
    const int least = l > 0 && fine.partition().ranks() > 1 ? 2 : 1;
    if (dim == 3)
      fine.depth =
          StagePass::depth(fine.box(), fine.partition().split(), least, 1 + int(relaxations(fine).after.size()));
    next.rhs = Field(next.box(), 1);
    next.solution = Field(next.box(), 1);
    next.scratch = Field(next.box(), 1);
  }
  PetscFunctionReturn(0);
}

void Multigrid::set_shift(double shift) {
  for (const Level &level : levels_) level->set_shift(shift);
}

std::size_t Multigrid::bytes() const {
  std::size_t sum = 0;
  for (const Level &level : levels_) sum += level->rhs.bytes() + level->solution.bytes() + level->scratch.bytes();
  return sum;
}

PetscErrorCode Multigrid::apply(const Field &rhs, Field &solution, Field &scratch, const RowsDone &rows_done) {
  PetscFunctionBeginUser;
  PetscCall(cycle(0, rhs, solution, scratch,
                  levels_[0]->box().wraps_x() && levels_[0]->box().dimension() == 3 ? rows_done : RowsDone()));
  PetscCall(levels_[0]->exchange().update_ghosts(solution, 1));
  PetscFunctionReturn(0);
}

// Ghost layers of the right-hand side that restriction and smoothing read.
int Multigrid::halo_of(const MultigridLevel &level) { return std::max(halo, level.depth - 1); }

// Applies the V-cycle from level l on. Does not update the ghosts of the solution.
PetscErrorCode Multigrid::cycle(std::size_t l, const Field &rhs, Field &solution, Field &scratch,
                                const RowsDone &rows_done) {
  PetscFunctionBeginUser;
  MultigridLevel &level = *levels_[l];
  if (level.single_cell()) {  // 0 without an inverse, because the solution is defined up to a constant
    if (level.has_cells() && level.is_regular()) solution[0](0, 0, 0) = level.step() * rhs[0](0, 0, 0);
    PetscFunctionReturn(0);
  }
  MultigridLevel &next = *levels_[l + 1];
  if (level.agglomeration)
    PetscCall(level.agglomeration->forward(rhs, next.rhs));
  else
    restrict_residual(level, rhs, next);
  PetscCall(next.exchange().update_ghosts(next.rhs, halo_of(next)));
  PetscCall(cycle(l + 1, next.rhs, next.solution, next.scratch, {}));
  if (level.agglomeration)
    PetscCall(level.agglomeration->backward(next.solution, solution));
  else
    PetscCall(smooth(level, next, rhs, solution, scratch, rows_done));
  PetscFunctionReturn(0);
}

// Sets solution = interpolated coarse solution + one relaxation of `rhs`, and smooths it.
PetscErrorCode Multigrid::smooth(MultigridLevel &fine, MultigridLevel &coarse, const Field &rhs, Field &solution,
                                 Field &scratch, const RowsDone &rows_done) {
  PetscFunctionBeginUser;
  const HaloOverlap sides(fine.box());
  const Relaxations &relax = relaxations(fine);
  std::vector<double> factors{relax.before * fine.step()};
  for (const double after : relax.after) factors.push_back(after * fine.step());
  const int stages = static_cast<int>(factors.size());
  for (int done = 0, depth; done < stages; done += depth) {
    const int passes = (stages - done + fine.depth - 1) / fine.depth;  // remaining passes, of about equal depth
    depth = (stages - done + passes - 1) / passes;
    if (done == 0)
      PetscCall(coarse.exchange().update_ghosts(coarse.solution, 1 + depth / 2));
    else
      PetscCall(fine.exchange().update_ghosts(solution, depth));
    const bool reports = rows_done && done + depth == stages;
    const Pass pass{&sides,
                    &fine,
                    done == 0 ? &coarse : nullptr,
                    factors.data() + done,
                    rhs[0],
                    {solution[0], scratch[0]},
                    depth,
                    fine.box().is_open(0, true) && fine.box().touches_high(0) ? fine.box().cells()[0] : -1,
                    &rows_done};
    const StagePass order(fine.box(), sides, depth + reports, 1, reports ? -1 : 0);
    if (fine.has_cells())
      order.for_tasks([&](const StagePass::Task &task) {
        (fine.box().dimension() == 2 ? stages_2d : stages_3d)(pass, order, task);
      });
    if (depth % 2) solution.swap(scratch);
  }
  PetscFunctionReturn(0);
}

// Sets coarse.rhs to the restricted residual after one relaxation from zero.
void Multigrid::restrict_residual(const MultigridLevel &fine, const Field &rhs, MultigridLevel &coarse) {
  if (!coarse.has_cells()) return;
  const double factor = relaxations(fine).before * fine.step();
  const int parts = row_parts(fine.box()), n = coarse.box().cells()[0];
  in_parallel(parts, parts, [&](int part) {
    const RowScratch sum(fine.box(), 1);
    (fine.box().dimension() == 2 ? restrict_2d : restrict_3d)(
        fine, factor, rhs[0], n, row_part(coarse.box(), part, parts), coarse.rhs[0], sum.row(0));
  });
}

}  // namespace eulastic
