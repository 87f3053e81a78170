#include "physics/super_time_stepping.hpp"

#include "base/events.hpp"
#include "field/walls.hpp"
#include "grid/blocks.hpp"
#include "kernels/super_time_stepping.hpp"

#include <algorithm>
#include <cmath>

namespace eulastic {
namespace {

// b_j of RKL2; b_0 = b_1 = b_2 = 1/3.
double weight(int j) { return j < 2 ? 1. / 3 : (double(j) * j + j - 2) / (2. * j * (j + 1)); }

// Fraction of dt that stage j has reached.
double stage_time(int j, int stages) {
  const double s = stages;
  return j == 1 ? stage_time(2, stages) / 3 : (double(j) * j + j - 2) / (s * s + s - 2);
}

kernels::RklStage stage_coefficients(int j, int stages, double dt, double viscosity) {
  const double w = 4. / (double(stages) * stages + stages - 2);
  const double mu = (2. * j - 1) / j * weight(j) / weight(j - 1);
  const double nu = -(j - 1.) / j * weight(j) / weight(j - 2);
  const double mu_tilde = mu * w, gamma_tilde = -(1 - weight(j - 1)) * mu_tilde;
  return {mu, nu, mu_tilde * dt * viscosity, (mu_tilde + gamma_tilde) * dt,
          mu_tilde * dt * stage_time(j - 1, stages) * dt};
}

// Whether any phase stresses an owned row.
std::vector<char> stressed_rows(const Grid &grid, const std::vector<Phase> &phases) {
  std::vector<char> stressed;
  for (const Segment &row : grid.rows()) {
    const auto stresses = [&](const Phase &phase) { return !phase.stressed.idle(row.j, row.k); };
    stressed.push_back(std::any_of(phases.begin(), phases.end(), stresses));
  }
  return stressed;
}

struct StageFields {
  const FieldBlock *rate, *slope;
  const std::vector<char> *stressed;  // owned rows; in the others slope is 0. Null: no slope at all
  FieldBlock *now, *before;
};

// Most stages in one pass over memory. Five took 3 % less time than four on one rank, and exchange more.
constexpr int deepest = 4;

// Stages j ... j + depth - 1.
struct Pass {
  int depth;
  kernels::RklStage stage[deepest];
  double twice_wall[deepest][3][3][2];  // of component a of what the stage reads, at a wall of direction d: 2 U
};

// One stage on the points `row` of component a.
template <int Dim>
EULASTIC_INLINE void stage_row(const Int3 &n, const kernels::RklStage &c, const InverseSquares &h, const StageFields &f,
                               int a, ConstView w, View out, const Segment &row) {
  const ConstView m = (*f.rate)[a];
  const bool owned = row.i_begin == 0 && row.i_end == n[0] && row.j >= 0 && row.j < n[1] && row.k >= 0 && row.k < n[2];
  if (!f.stressed || (owned && !(*f.stressed)[row.j + std::size_t(n[1]) * row.k]))
    kernels::rkl_stage<Dim, false>(row, c, w, m, m, h, out);
  else
    kernels::rkl_stage<Dim, true>(row, c, w, m, (*f.slope)[a], h, out);
}

// Whether a row lies on a low wall that its component is normal to: W is 0 there and stays so.
EULASTIC_INLINE bool is_on_wall(const Sides &sides, int a, const Segment &row) {
  return (a == 1 && sides.wall[1][0] && row.j == 0) || (a == 2 && sides.wall[2][0] && row.k == 0);
}

// What a stage reads beside its points `row`, made when it comes to them: across a periodic x and behind walls that its
// component is tangential to.
template <int Dim>
EULASTIC_INLINE void surround_row(const Int3 &n, const Sides &sides, const double (&twice_wall)[3][2], int a, View w,
                                  const Segment &at) {
  double *row = w.row(at.j, at.k);
  if (sides.wraps_x) {
    row[-1] = row[n[0] - 1];
    row[n[0]] = row[0];
  }
  const int place[3] = {0, at.j, at.k};
  for (int d = 0; d < Dim; ++d)
    for (int side = 0; side < 2; ++side) {
      const int last = d == 0 ? place[0] : side ? n[d] - 1 : 0;
      if (a == d || !sides.wall[d][side] || place[d] != last) continue;
      const std::ptrdiff_t s = w.stride(d);
      const double twice = twice_wall[d][side];
      if (d == 0) {
        double *inside = side ? row + n[0] - 1 : row;
        inside[side ? 1 : -1] = twice - inside[0];
      } else {
        double *ghost = side ? row + s : row - s;
#pragma omp simd
        for (int i = at.i_begin; i < at.i_end; ++i) ghost[i] = twice - row[i];
      }
    }
}

// Stages alternate: the first reads W_j-1 in `now` and writes W_j over W_j-2 in `before`, the next the other way. The
// first asks for rows ahead.
template <int Dim>
EULASTIC_INLINE void stages_of_task(const Grid &grid, const Pass &pass, const InverseSquares &h, const Sides &sides,
                                    const StageFields &f, const StagePass &order, const StagePass::Task &task) {
  const Int3 n = grid.owned();
  const int a = task.field;
  order.go<Dim>(task, [&](int s, Segment row, int j_end) EULASTIC_BODY {
    const View w = (*(s % 2 ? f.before : f.now))[a], out = (*(s % 2 ? f.now : f.before))[a];
    const int first = row.j;
    for (; row.j < j_end; ++row.j) {
      if (Dim == 3 && s == 0) {
        const RowAhead next(first, j_end, row.j, row.k);
        prefetch(w.row(next.j, next.k + 1), n[0]);
        prefetch(out.row(next.j, next.k), n[0]);
        prefetch((*f.rate)[a].row(next.j, next.k), n[0]);
        if (f.stressed) prefetch((*f.slope)[a].row(next.j, next.k), n[0]);
      }
      if (is_on_wall(sides, a, row)) continue;
      surround_row<Dim>(n, sides, pass.twice_wall[s][a], a, w, row);
      stage_row<Dim>(n, pass.stage[s], h, f, a, w, out, row);
      if (a == 0 && sides.wall[0][0]) out.row(row.j, row.k)[0] = 0;
    }
  });
}

EULASTIC_CLONES void stages_2d(const Grid &grid, const Pass &pass, const InverseSquares &h, const Sides &sides,
                               const StageFields &f, const StagePass &order, const StagePass::Task &task) {
  stages_of_task<2>(grid, pass, h, sides, f, order, task);
}
EULASTIC_CLONES void stages_3d(const Grid &grid, const Pass &pass, const InverseSquares &h, const Sides &sides,
                               const StageFields &f, const StagePass &order, const StagePass::Task &task) {
  stages_of_task<3>(grid, pass, h, sides, f, order, task);
}

// to = scale a + b at all points of the part, wrapped by one; b may be null.
EULASTIC_CLONES void scale_add_part(const Grid &grid, const RowPart &part, double scale, const FieldBlock &a,
                                    const FieldBlock *b, FieldBlock &to) {
  const Int3 n = grid.owned();
  for (int c = 0; c < to.count(); ++c)
    for (int k = part.k_begin; k < part.k_end; ++k)
      for (int j = part.j_begin; j < part.j_end; ++j) {
        const double *x = a[c].row(j, k);
        double *out = to[c].row(j, k);
        if (b) {
          const double *y = (*b)[c].row(j, k);
#pragma omp simd
          for (int i = 0; i < n[0]; ++i) out[i] = kernels::fma(scale, x[i], y[i]);
        } else {
          for (int i = 0; i < n[0]; ++i) out[i] = scale * x[i];
        }
        if (grid.wraps_x()) grid.wrap_row(out, 1);
      }
}

void scale_add(const Grid &grid, double scale, const FieldBlock &a, const FieldBlock *b, FieldBlock &to) {
  in_row_parts(grid, [&](const RowPart &part) { scale_add_part(grid, part, scale, a, b, to); });
}

}  // namespace

int rkl_stages(double dt, double dt_explicit) {
  if (!(dt_explicit > 0) || std::isinf(dt_explicit)) return 3;
  const double s = std::ceil(0.5 * (std::sqrt(9 + 16 * dt / dt_explicit) - 1) - 1e-9);
  const int stages = s < 3 ? 3 : static_cast<int>(std::fmin(s, 1e6));
  return stages % 2 ? stages : stages + 1;
}

PetscErrorCode super_time_step(const Grid &grid, GhostExchange &exchange, const Walls &walls,
                               double kinematic_viscosity, double time, double dt, int stages,
                               const std::vector<Phase> &phases, const FieldBlock &velocity, SuperTimeStepping &work,
                               FieldBlock &velocity_star) {
  PetscFunctionBeginUser;
  VerbScope scope(Verb::viscous);
  const InverseSquares h = grid.inverse_squares();
  const double first = stages == 1 ? 1 : weight(1) * 4. / (double(stages) * stages + stages - 2);  // mu~_1
  if (work.slope) scale_add(grid, -0.5 * dt, work.slope, &work.rate, work.rate);  // the force at the start
  scale_add(grid, first * dt, work.rate, nullptr, work.now);
  for (int d = 0; d < grid.dimension(); ++d)
    if (grid.is_wall(d)) close_wall_faces(grid, work.now[d], d);
  if (stages > 1) work.before.clear();
  const Sides sides(grid);
  const int depth = StagePass::depth(grid, sides, 2, deepest);
  std::vector<char> stressed;
  if (work.slope) {
    PetscCall(exchange.update_rows(work.rate, depth - 1, work.slope, depth - 1));
    stressed = stressed_rows(grid, phases);
  } else {
    PetscCall(exchange.update_rows(work.rate, depth - 1));
  }
  const auto time_of = [&](int j) { return time + stage_time(j, stages) * dt; };
  Pass pass;
  for (int j = 2; j <= stages; j += pass.depth) {
    const int passes = (stages - j + depth) / depth;  // that are left, of equal depth
    pass.depth = (stages - j + passes) / passes;
    for (int s = 0; s < pass.depth; ++s) {
      pass.stage[s] = stage_coefficients(j + s, stages, dt, kinematic_viscosity);
      for (int d = 0; d < 3; ++d)
        for (int side = 0; side < 2; ++side) {
          const Real3 u = walls.motion[d][side].at(time), v = walls.motion[d][side].at(time_of(j + s - 1));
          for (int a = 0; a < 3; ++a) pass.twice_wall[s][a][d][side] = 2 * (v[a] - u[a]);
        }
    }
    if (j > 2 && pass.depth > 2)
      PetscCall(exchange.update_rows(work.now, pass.depth, work.before, pass.depth - 1));
    else
      PetscCall(exchange.update_rows(work.now, pass.depth));
    const StageFields fields{&work.rate, &work.slope, work.slope ? &stressed : nullptr, &work.now, &work.before};
    const StagePass order(grid, sides, pass.depth, grid.dimension());
    order.for_tasks([&](const StagePass::Task &task) {
      (grid.dimension() == 2 ? stages_2d : stages_3d)(grid, pass, h, sides, fields, order, task);
    });
    if (pass.depth % 2) work.now.swap(work.before);
  }
  scale_add(grid, 1, work.now, &velocity, velocity_star);
  scope.flops(grid.owned_count() * grid.dimension() *
              ((stages - 1) * (grid.dimension() == 2 ? kernels::rkl_stage_flops_2d : kernels::rkl_stage_flops_3d) + 3));
  PetscFunctionReturn(0);
}

}  // namespace eulastic
