#include "physics/super_time_stepping.hpp"

#include "base/events.hpp"
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

// The part of every row that any phase stresses, whole vectors where the row is long enough.
std::vector<Segment> stressed_parts(const Grid &grid, const std::vector<Phase> &phases) {
  std::vector<Segment> parts = grid.rows();
  for (Segment &part : parts) {
    const int cells = part.i_end;
    int begin = cells, end = 0;
    for (const Phase &phase : phases) {
      const ActiveSegments::Range range = phase.stressed.row(part.j, part.k);
      if (range.first == range.last) continue;
      begin = std::min(begin, range.first->i_begin);
      end = std::max(end, (range.last - 1)->i_end);
    }
    part.i_end = std::min((end + 7) / 8 * 8, cells);
    part.i_begin = std::min(begin, part.i_end);
  }
  return parts;
}

struct StageFields {
  const FieldBlock *rate, *slope;
  const std::vector<Segment> *stressed;  // one part per owned row; elsewhere slope is 0. Null: no slope at all
  FieldBlock *now, *before;
};

// Where W_j is needed for the stage after it: at the owned points and one layer around them. That layer is computed
// again instead of exchanged; in an x that is not split it is the other end of the row, behind walls their ghosts.
struct Surroundings {
  Int3 begin{}, end{};
  bool wraps_x;
  bool wall[3][2];
  double twice_wall[3][3][2];  // of component a, at a wall of direction d: 2 U

  Surroundings(const Grid &grid, const Walls &walls, double from, double to) {
    wraps_x = grid.boundary(0) == Boundary::periodic && grid.processors(0) == 1;
    for (int d = 0; d < 3; ++d) {
      wall[d][0] = grid.touches_low(d);
      wall[d][1] = grid.touches_high(d);
      const bool alone = d >= grid.dimension() || (d == 0 && wraps_x);
      begin[d] = alone || wall[d][0] ? 0 : -1;
      end[d] = grid.owned()[d] + (alone || wall[d][1] ? 0 : 1);
      for (int side = 0; side < 2; ++side) {
        const Real3 u = walls.motion[d][side].at(from), v = walls.motion[d][side].at(to);
        for (int a = 0; a < 3; ++a) twice_wall[a][d][side] = 2 * (v[a] - u[a]);
      }
    }
  }
};

// One stage on row (j, k), the points [begin, end).
template <int Dim>
EULASTIC_INLINE void stage_row(const Int3 &n, const kernels::RklStage &c, const InverseSquares &h, const StageFields &f,
                               int a, ConstView w, View out, const Segment &row) {
  const ConstView m = (*f.rate)[a];
  if (!f.stressed) {
    kernels::rkl_stage<Dim, false>(row, c, w, m, m, h, out);
    return;
  }
  const ConstView m1 = (*f.slope)[a];
  const bool owned = row.i_begin == 0 && row.i_end == n[0] && row.j >= 0 && row.j < n[1] && row.k >= 0 && row.k < n[2];
  const Segment part = owned ? (*f.stressed)[row.j + std::size_t(n[1]) * row.k] : row;
  if (part.size() == 0) {
    kernels::rkl_stage<Dim, false>(row, c, w, m, m, h, out);
    return;
  }
  kernels::rkl_stage<Dim, false>({row.i_begin, part.i_begin, row.j, row.k}, c, w, m, m, h, out);
  kernels::rkl_stage<Dim, true>(part, c, w, m, m1, h, out);
  kernels::rkl_stage<Dim, false>({part.i_end, row.i_end, row.j, row.k}, c, w, m, m, h, out);
}

// What the next stage reads beside row (j, k) of component a: the points across a periodic x and behind walls.
template <int Dim>
EULASTIC_INLINE void surround_row(const Int3 &n, const Surroundings &around, int a, View w, int j, int k) {
  double *row = w.row(j, k);
  if (around.wraps_x) {
    row[-1] = row[n[0] - 1];
    row[n[0]] = row[0];
  }
  const int place[3] = {0, j, k};
  for (int d = 0; d < Dim; ++d)
    for (int side = 0; side < 2; ++side) {
      const int last = d == 0 ? place[0] : side ? n[d] - 1 : 0;
      if (!around.wall[d][side] || place[d] != last) continue;
      const std::ptrdiff_t s = w.stride(d);
      const double twice = around.twice_wall[a][d][side];
      if (d == 0) {
        double *inside = side ? row + n[0] - 1 : row;
        (a == d && !side ? inside[0] : inside[side ? 1 : -1]) = a == d ? 0 : twice - inside[0];
      } else if (a == d) {
        double *face = side ? row + s : row;
        for (int i = 0; i < n[0]; ++i) face[i] = 0;
      } else {
        double *ghost = side ? row + s : row - s;
#pragma omp simd
        for (int i = 0; i < n[0]; ++i) ghost[i] = twice - row[i];
      }
    }
}

// Stages j and j + 1 in one pass over memory: W_j on a slice (a plane, in 2-D a row), then W_j+1 on the one before.
// `before` holds W_j-2 and gets W_j, `now` holds W_j-1 and gets W_j+1.
template <int Dim>
EULASTIC_INLINE void stage_pair(const Grid &grid, const kernels::RklStage *c, const InverseSquares &h,
                                const Surroundings &around, const StageFields &f) {
  constexpr int last = Dim - 1;
  const Int3 n = grid.owned();
  const Int3 &begin = around.begin, &end = around.end;
  for (int a = 0; a < Dim; ++a) {
    const View now = (*f.now)[a], before = (*f.before)[a];
    const auto first_stage = [&](int slice) EULASTIC_BODY {
      for (int r = Dim == 3 ? begin[1] : slice; r < (Dim == 3 ? end[1] : slice + 1); ++r) {
        const int k = Dim == 3 ? slice : 0;
        stage_row<Dim>(n, c[0], h, f, a, now, before, {begin[0], end[0], r, k});
        surround_row<Dim>(n, around, a, before, r, k);
      }
    };
    const auto second_stage = [&](int slice) EULASTIC_BODY {
      for (int r = Dim == 3 ? 0 : slice; r < (Dim == 3 ? n[1] : slice + 1); ++r)
        stage_row<Dim>(n, c[1], h, f, a, before, now, {0, n[0], r, Dim == 3 ? slice : 0});
    };
    for (int slice = begin[last]; slice < end[last]; ++slice) {
      first_stage(slice);
      if (slice > 0) second_stage(slice - 1);
    }
    if (end[last] == n[last]) second_stage(n[last] - 1);
  }
}

EULASTIC_CLONES void stage_pair_2d(const Grid &grid, const kernels::RklStage *c, const InverseSquares &h,
                                   const Surroundings &around, const StageFields &f) {
  stage_pair<2>(grid, c, h, around, f);
}
EULASTIC_CLONES void stage_pair_3d(const Grid &grid, const kernels::RklStage *c, const InverseSquares &h,
                                   const Surroundings &around, const StageFields &f) {
  stage_pair<3>(grid, c, h, around, f);
}

// to = scale a + b at all owned points; b may be null.
EULASTIC_CLONES void scale_add(const Grid &grid, double scale, const FieldBlock &a, const FieldBlock *b,
                               FieldBlock &to) {
  const Int3 n = grid.owned();
  for (int c = 0; c < to.count(); ++c)
    for (int k = 0; k < n[2]; ++k)
      for (int j = 0; j < n[1]; ++j) {
        const double *x = a[c].row(j, k);
        double *out = to[c].row(j, k);
        if (b) {
          const double *y = (*b)[c].row(j, k);
#pragma omp simd
          for (int i = 0; i < n[0]; ++i) out[i] = kernels::fma(scale, x[i], y[i]);
        } else {
          for (int i = 0; i < n[0]; ++i) out[i] = scale * x[i];
        }
      }
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
  if (stages > 1) work.before.clear();
  PetscCall(exchange.update(work.rate, 1));
  std::vector<Segment> stressed;
  if (work.slope) {
    PetscCall(exchange.update(work.slope, 1));
    stressed = stressed_parts(grid, phases);
  }
  const auto time_of = [&](int j) { return time + stage_time(j, stages) * dt; };
  for (int j = 2; j < stages; j += 2) {
    PetscCall(exchange.update(work.now, 2));
    fill_wall_ghosts_velocity_change(grid, walls, time, time_of(j - 1), work.now, 1);
    const kernels::RklStage pair[2] = {stage_coefficients(j, stages, dt, kinematic_viscosity),
                                       stage_coefficients(j + 1, stages, dt, kinematic_viscosity)};
    (grid.dimension() == 2 ? stage_pair_2d : stage_pair_3d)(
        grid, pair, h, Surroundings(grid, walls, time, time_of(j)),
        {&work.rate, &work.slope, work.slope ? &stressed : nullptr, &work.now, &work.before});
  }
  scale_add(grid, 1, work.now, &velocity, velocity_star);
  scope.flops(grid.owned_count() * grid.dimension() *
              ((stages - 1) * (grid.dimension() == 2 ? kernels::rkl_stage_flops_2d : kernels::rkl_stage_flops_3d) + 3));
  PetscFunctionReturn(0);
}

}  // namespace eulastic
