#include "flow/super_time_stepping.hpp"

#include "base/events.hpp"
#include "field/open_sides.hpp"
#include "flow/rkl_coefficients.hpp"
#include "grid/blocks.hpp"
#include "rigid/rigid_surfaces.hpp"

#include <algorithm>
#include <cmath>

namespace eulastic {
namespace {

struct StageFields {
  Field *rate;  // M_0, with the first stage M_0 - dt/2 M_1
  const Field *slope;
  const std::vector<char> *stressed;  // owned rows; in the others slope is 0. Null: no slope at all
  Field *now, *before;
  const Field *velocity;
  Field *velocity_star;
  const RigidFaces *rigid;
  std::vector<RigidStage> *rigid_stages;  // of the pass

  bool has_slope(const Int3 &n, const Segment &row) const {
    const bool owned =
        row.i_begin == 0 && row.i_end == n[0] && row.j >= 0 && row.j < n[1] && row.k >= 0 && row.k < n[2];
    return stressed && !(owned && !(*stressed)[row.j + std::size_t(n[1]) * row.k]);
  }
};

// Most stages in one pass over memory, the first one not counted. Five took 3 % less time than four on one rank, and
// exchange more.
constexpr int deepest = 4;

// Stages j ... j + depth - 1; before them the first one, W_1, and after them v*, where the pass starts and ends all.
struct Pass {
  int depth;
  bool starts, ends;
  double first, half;  // W_1 = first (M_0 + half M_1)
  kernels::RklStage stage[deepest];
  double twice_wall[deepest][3][3][2];  // of component a of what the stage reads, at a wall of direction d: 2 U
  double image[3][2];                   // the mirror image's sign behind a side, of tangential components
  double inflow[deepest][3][2];         // what the stage's input has more of on an inflow side than at the start
};

// The first stage of component a: M_0 for good, and W_1.
EULASTIC_CLONES void first_stage_row(const Int3 &n, const Pass &pass, const StageFields &f, int a, const Segment &row) {
  double *m = (*f.rate)[a].row(row.j, row.k), *out = (*f.now)[a].row(row.j, row.k);
  if (f.has_slope(n, row)) {
    const double *slope = (*f.slope)[a].row(row.j, row.k);
#pragma omp simd
    for (int i = row.i_begin; i < row.i_end; ++i) m[i] = kernels::fma(pass.half, slope[i], m[i]);
  }
#pragma omp simd
  for (int i = row.i_begin; i < row.i_end; ++i) out[i] = pass.first * m[i];
}

// One stage on the points `row` of component a.
template <int Dim>
EULASTIC_INLINE void stage_row(const Int3 &n, const kernels::RklStage &c, const InverseSquares &h, const StageFields &f,
                               int a, ConstView w, View out, const Segment &row) {
  const ConstView m = (*f.rate)[a];
  if (f.has_slope(n, row))
    kernels::rkl_stage<Dim, true>(row, c, w, m, (*f.slope)[a], h, out);
  else
    kernels::rkl_stage<Dim, false>(row, c, w, m, m, h, out);
}

// The same where there are rigid bodies: none on rows inside, and cut faces by themselves.
template <int Dim>
EULASTIC_INLINE void stage_beside_rigid(const Int3 &n, const kernels::RklStage &c, const InverseSquares &h,
                                        const StageFields &f, const RigidStage &rigid, int a, ConstView w, View out,
                                        const Segment &row) {
  const RigidFaces::Row faces = f.rigid->row(a, row.j, row.k);
  if (faces.all) return;
  if (faces.empty()) return stage_row<Dim>(n, c, h, f, a, w, out, row);
  thread_local std::vector<double> held;
  const double *slope = f.has_slope(n, row) ? (*f.slope)[a].row(row.j, row.k) : nullptr;
  rigid.hold(faces, Dim, a, row.i_begin, row.i_end, c, w.row(row.j, row.k), {1, w.sy, w.sz},
             (*f.rate)[a].row(row.j, row.k), slope, out.row(row.j, row.k), &held);
  stage_row<Dim>(n, c, h, f, a, w, out, row);
  RigidStage::release(faces, row.i_begin, row.i_end, held, out.row(row.j, row.k));
}

// Sides of the box as stages see them.
struct StageSides : Sides {
  bool fixed[3][2];  // here, and the normal velocity on it is given
  bool open[3][2];   // here, and it is an unknown
  bool any_beside;   // anything but closed sides that stay so: beside_row() has something to do
  const Box *box;
  const BoxSides *box_sides;

  StageSides(const Box &g, const BoxSides &b) : Sides(g), any_beside(false), box(&g), box_sides(&b) {
    for (int d = 0; d < 3; ++d) {
      for (const bool high : {false, true}) {
        open[d][high] = wall[d][high] && g.is_open(d, high);
        fixed[d][high] = wall[d][high] && !open[d][high];
        any_beside = any_beside || open[d][high] || (fixed[d][high] && b[d][high].kind == SideKind::inflow);
      }
      beyond[d] = open[d][1];
    }
  }
};

// Whether a row lies on a low side that its component is normal to, and where it is given.
EULASTIC_INLINE bool is_on_wall(const StageSides &sides, int a, const Segment &row) {
  return (a == 1 && sides.fixed[1][0] && row.j == 0) || (a == 2 && sides.fixed[2][0] && row.k == 0);
}

// What a stage reads beside its points `at` in the direction that its component is normal to: what is given on an
// inflow side, the mirror image about an open one.
[[gnu::noinline]] void beside_row(const StageSides &sides, const double (&inflow)[3][2], int a, View w,
                                  const Segment &at) {
  const Int3 &n = sides.box->cells();
  double *row = w.row(at.j, at.k);
  const int place[3] = {0, at.j, at.k};
  for (const bool high : {false, true}) {
    const int face = high ? n[a] : 0, inside = high ? n[a] - 1 : 1;
    const std::ptrdiff_t outward = high ? w.stride(a) : -w.stride(a);
    if (sides.open[a][high] && a == 0) row[face + outward] = row[inside];
    if (sides.open[a][high] && a != 0 && place[a] == face)
      for (int i = at.i_begin; i < at.i_end; ++i) row[i + outward] = row[i - outward];
    const Side &side = (*sides.box_sides)[a][high];
    if (!sides.fixed[a][high] || side.kind != SideKind::inflow || inflow[a][high] == 0) continue;
    if (a == 0) set_inflow_row(*sides.box, side, a, high, inflow[a][high], at, w);
    if (a != 0 && place[a] == inside) {
      Segment face_row = at;
      (a == 1 ? face_row.j : face_row.k) = face;
      set_inflow_row(*sides.box, side, a, high, inflow[a][high], face_row, w);
    }
  }
}

// What a stage reads beside its points `row`, made when it comes to them: across a periodic x and behind sides that its
// component is tangential to.
template <int Dim>
EULASTIC_INLINE void surround_row(const Int3 &n, const StageSides &sides, const double (&twice_wall)[3][2],
                                  const double (&image)[3][2], int a, View w, const Segment &at) {
  double *row = w.row(at.j, at.k);
  sides.wrap(row);
  const int place[3] = {0, at.j, at.k};
  for (int d = 0; d < Dim; ++d)
    for (int side = 0; side < 2; ++side) {
      const int last = d == 0 ? place[0] : side ? n[d] - 1 : 0;
      if (a == d || !sides.wall[d][side] || place[d] != last) continue;
      const std::ptrdiff_t s = w.stride(d);
      const double twice = twice_wall[d][side], sign = image[d][side];
      if (d == 0) {
        double *inside = side ? row + n[0] - 1 : row;
        inside[side ? 1 : -1] = twice + sign * inside[0];
      } else {
        double *ghost = side ? row + s : row - s;
#pragma omp simd
        for (int i = at.i_begin; i < at.i_end; ++i) ghost[i] = twice + sign * row[i];
      }
    }
}

// v* of component a.
EULASTIC_CLONES void end_row(const StageFields &f, int a, ConstView w, const Segment &row) {
  const double *increment = w.row(row.j, row.k), *v = (*f.velocity)[a].row(row.j, row.k);
  double *out = (*f.velocity_star)[a].row(row.j, row.k);
#pragma omp simd
  for (int i = row.i_begin; i < row.i_end; ++i) out[i] = increment[i] + v[i];
}

// Stages alternate: the first of a pass reads W_j-1 in `now` and writes W_j over W_j-2 in `before`, the next the other
// way. Rows ahead are asked for with the first.
template <int Dim>
EULASTIC_INLINE void stages_of_task(const Box &box, const Pass &pass, const InverseSquares &h, const StageSides &sides,
                                    const StageFields &f, const StagePass &order, const StagePass::Task &task) {
  const Int3 n = box.cells();
  const int a = task.field;
  order.go<Dim>(task, [&](int stage, Segment row, int j_end) EULASTIC_BODY {
    // Faces beyond the last cells are those of the component normal to them.
    if (a != 0) row.i_end -= sides.beyond[0];
    if (a != 1 && sides.beyond[1]) j_end = std::min(j_end, n[1]);
    if (Dim == 3 && a != 2 && sides.beyond[2] && row.k == n[2]) return;
    const int s = stage - pass.starts;  // -1: W_1
    const View w = (*(s % 2 ? f.before : f.now))[a], out = (*(s % 2 ? f.now : f.before))[a];
    const int first = row.j;
    for (; row.j < j_end; ++row.j) {
      if (Dim == 3) {
        const RowAhead next(first, j_end, row.j, row.k);
        const auto prefetch_row = [&](const Field *field, int k) { prefetch((*field)[a].row(next.j, k), n[0]); };
        if (stage == 0) {
          prefetch_row(f.now, s < 0 ? next.k : next.k + 1);
          prefetch_row(f.rate, next.k);
          if (f.stressed) prefetch_row(f.slope, next.k);
        }
        if (s == 0) prefetch_row(f.before, next.k);
        if (pass.ends && s == pass.depth - 1) prefetch_row(f.velocity, next.k);
      }
      if (!is_on_wall(sides, a, row)) {
        double *values = out.row(row.j, row.k);
        if (s < 0) {
          first_stage_row(n, pass, f, a, row);
        } else {
          if (pass.starts && s == 0) std::fill(values + row.i_begin, values + row.i_end, 0.0);  // W_0
          surround_row<Dim>(n, sides, pass.twice_wall[s][a], pass.image, a, w, row);
          if (sides.any_beside) beside_row(sides, pass.inflow[s], a, w, row);
          if (f.rigid)
            stage_beside_rigid<Dim>(n, pass.stage[s], h, f, (*f.rigid_stages)[s], a, w, out, row);
          else
            stage_row<Dim>(n, pass.stage[s], h, f, a, w, out, row);
        }
        if (a == 0 && sides.fixed[0][0]) values[0] = 0;
      }
      if (pass.ends && s == pass.depth - 1) end_row(f, a, out, row);
    }
  });
}

EULASTIC_CLONES void stages_2d(const Box &box, const Pass &pass, const InverseSquares &h, const StageSides &sides,
                               const StageFields &f, const StagePass &order, const StagePass::Task &task) {
  stages_of_task<2>(box, pass, h, sides, f, order, task);
}
EULASTIC_CLONES void stages_3d(const Box &box, const Pass &pass, const InverseSquares &h, const StageSides &sides,
                               const StageFields &f, const StagePass &order, const StagePass::Task &task) {
  stages_of_task<3>(box, pass, h, sides, f, order, task);
}

// No flow through sides, but what stages find on open ones.
void close_walls(const Box &box, Field &velocity) {
  for (int d = 0; d < box.dimension(); ++d)
    if (box.is_wall(d)) close_wall_faces(box, velocity[d], d);
}

}  // namespace

std::vector<char> stressed_rows(const Box &box, const std::vector<Phase> &phases) {
  std::vector<char> stressed;
  for (const Segment &row : box.rows()) {
    const auto stresses = [&](const Phase &phase) {
      return !phase.tensor.stressed.idle(row.j, row.k) ||
             (phase.material.surface_tension > 0 && !phase.rows.idle(row.j, row.k));
    };
    stressed.push_back(std::any_of(phases.begin(), phases.end(), stresses));
  }
  return stressed;
}

int rkl_stages(double dt, double dt_explicit) {
  if (!(dt_explicit > 0) || std::isinf(dt_explicit)) return 3;
  const double s = std::ceil(0.5 * (std::sqrt(9 + 16 * dt / dt_explicit) - 1) - 1e-9);
  const int stages = s < 3 ? 3 : static_cast<int>(std::fmin(s, 1e6));
  return stages % 2 ? stages : stages + 1;
}

namespace {

// Stage s of a pass reads what is behind sides at a time `now`, less what was there at the start.
void set_sides(const BoxSides &box_sides, double start, double now, int s, Pass *pass) {
  for (int d = 0; d < 3; ++d)
    for (int side = 0; side < 2; ++side) {
      const Side &at = box_sides[d][side];
      const Real3 u = at.motion.at(start), v = at.motion.at(now);
      for (int a = 0; a < 3; ++a) pass->twice_wall[s][a][d][side] = 2 * (v[a] - u[a]);
      pass->inflow[s][d][side] = at.kind == SideKind::inflow ? at.given.at(now) - at.given.at(start) : 0;
    }
}

}  // namespace

PetscErrorCode super_time_step(const Domain &domain, GhostExchange &exchange, const BoxSides &box_sides,
                               double kinematic_viscosity, double time, double dt, int stages,
                               const std::vector<char> &stressed, const Field &velocity, SuperTimeStepping &work,
                               Field &velocity_star, const RigidFaces *rigid, RigidMeans *means) {
  PetscFunctionBeginUser;
  VerbScope scope(Verb::viscous);
  const InverseSquares h = domain.inverse_squares();
  const StageSides sides(domain, box_sides);
  const int depth = StagePass::depth(domain, domain.split(), 2, deepest);
  for (Field *field : {&work.rate, &work.slope, &work.now, &work.before})
    if (*field) close_walls(domain, *field);
  std::vector<WantedGhosts> forces{{&work.rate, depth, nullptr, false}};
  if (work.slope) forces.push_back({&work.slope, depth, nullptr, false});
  PetscCall(exchange.update_ghosts(forces));
  const auto time_of = [&](int j) { return time + rkl_stage_time(j, stages) * dt; };
  Pass pass;
  for (int d = 0; d < 3; ++d)
    for (int side = 0; side < 2; ++side) {
      const SideKind kind = box_sides[d][side].kind;
      pass.image[d][side] = kind == SideKind::wall || kind == SideKind::inflow ? -1 : 1;
    }
  pass.first = rkl_first_step(stages, dt);
  pass.half = -0.5 * dt;  // the force at the start
  const std::vector<double> weights = rigid ? rkl_mean_weights(stages) : std::vector<double>();
  int j = 2;
  do {
    const int left = stages - j + 1, passes = (left + depth - 1) / depth;  // of equal depth
    pass.depth = passes > 0 ? (left + passes - 1) / passes : 0;
    pass.starts = j == 2;
    pass.ends = pass.depth == left;
    std::vector<RigidStage> rigid_stages;
    for (int s = 0; s < pass.depth; ++s) {
      if (rigid) rigid_stages.emplace_back(*rigid, 1, time, time_of(j + s - 1), weights[j + s], means);
      pass.stage[s] = rkl_stage_coefficients(j + s, stages, dt, kinematic_viscosity);
      set_sides(box_sides, time, time_of(j + s - 1), s, &pass);
    }
    if (!pass.starts) {
      std::vector<WantedGhosts> read{{&work.now, pass.depth, nullptr, false}};
      if (pass.depth > 2) read.push_back({&work.before, pass.depth - 1, nullptr, false});
      PetscCall(exchange.update_ghosts(read));
    }
    const StageFields fields{&work.rate,     &work.slope,  work.slope ? &stressed : nullptr,
                             &work.now,      &work.before, &velocity,
                             &velocity_star, rigid,        &rigid_stages};
    const StagePass order(domain, sides, pass.depth + pass.starts, domain.dimension());
    order.for_tasks([&](const StagePass::Task &task) {
      (domain.dimension() == 2 ? stages_2d : stages_3d)(domain, pass, h, sides, fields, order, task);
    });
    if (pass.depth % 2) work.now.swap(work.before);
    j += pass.depth;
  } while (!pass.ends);
  scope.flops(
      domain.cell_count() * domain.dimension() *
      ((stages - 1) * (domain.dimension() == 2 ? kernels::rkl_stage_flops_2d : kernels::rkl_stage_flops_3d) + 3));
  PetscFunctionReturn(0);
}

}  // namespace eulastic
