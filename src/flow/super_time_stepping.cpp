#include "flow/super_time_stepping.hpp"

#include "base/events.hpp"
#include "field/open_boundaries.hpp"
#include "flow/rkl_coefficients.hpp"
#include "flow/stress_rows.hpp"
#include "flow/tangential_stress.hpp"
#include "grid/blocks.hpp"
#include "rigid/rigid_surfaces.hpp"

#include <algorithm>
#include <cmath>

namespace eulastic {
namespace {

// Boundaries of the box for the stages.
struct StageSides : HaloOverlap {
  bool fixed[3][2];  // this rank touches the boundary, and the normal velocity on it is given
  bool open[3][2];   // this rank touches the boundary, and the normal velocity on it is an unknown
  bool any_beside;   // any boundary is open or an inflow, so that beside_row() is needed

  StageSides(const Box &box, const BoundaryConditions &sides) : HaloOverlap(box), any_beside(false) {
    for (int d = 0; d < 3; ++d) {
      for (const bool high : {false, true}) {
        open[d][high] = wall[d][high] && box.is_open(d, high);
        fixed[d][high] = wall[d][high] && !open[d][high];
        any_beside = any_beside || open[d][high] || (fixed[d][high] && sides[d][high].kind == BoundaryKind::inflow);
      }
      beyond[d] = open[d][1];
    }
  }
  /// Whether a row lies on a low boundary that is normal to its component and has a given velocity.
  EULASTIC_INLINE bool holds(int a, const Segment &row) const {
    return (a == 1 && fixed[1][0] && row.j == 0) || (a == 2 && fixed[2][0] && row.k == 0);
  }
};

// Largest number of stages that share a pass over memory, without the first one. Every additional stage needs another
// layer of ghosts to exchange and to recompute.
constexpr int deepest = 4;

// The stages number ... number + depth - 1 of one pass over memory. The first pass begins with stage 1, W_1, and the
// last one ends with v*. The first stage of a pass reads W_j-1 in `now` and replaces W_j-2 in `before` by W_j, the next
// one vice versa.
struct Pass {
  const Domain &domain;
  const ViscousStep &step;
  const StageSides &sides;
  SuperTimeStepping &work;
  Field &velocity_star;
  int number, depth;
  bool starts, ends;
  double first, half;  // W_1 = first (M_0 + half M_1), with the force at the start of the step
  kernels::RklStage stage[deepest];
  BoundaryConditions increments[deepest];  // given values on boundaries when a stage reads, less those at the start
  std::vector<RigidStage> rigid;

  bool has_slope(const Segment &row) const {
    const Int3 &n = domain.cells();
    const bool owned =
        row.i_begin == 0 && row.i_end == n[0] && row.j >= 0 && row.j < n[1] && row.k >= 0 && row.k < n[2];
    return work.slope && !(owned && !step.stressed[row.j + std::size_t(n[1]) * row.k]);
  }
};

// Computes one stage on the points `row` of component a. force(i) returns the viscous term at offset i of the row.
template <class Force>
EULASTIC_INLINE void stage_row(const Pass &pass, int s, int a, const Segment &row, ConstView w, const Force &force,
                               View out) {
  const ConstView m = pass.work.rate[a];
  if (pass.has_slope(row))
    kernels::rkl_stage<true>(row, pass.stage[s], w, m, pass.work.slope[a], force, out);
  else
    kernels::rkl_stage<false>(row, pass.stage[s], w, m, m, force, out);
}

// Below are the viscous terms of the stages. If components are coupled (`couples`), a stage has a pass of its own,
// which processes all components together. prepare() is called before each pass, surround() before each row of a stage.

// nu lap W, with separate components. Ghosts behind boundaries are filled row by row, when the stages of a pass reach
// them.
struct UniformViscosity {
  static constexpr bool couples = false;
  // viscosity: in the coefficients of all faces; beside_rigid: additional factor at cut faces
  const double viscosity, beside_rigid = 1;
  const InverseSquares h;
  const int depth;

  UniformViscosity(const Domain &domain, const ViscousStep &step)
      : viscosity(step.viscosity),
        h(domain.inverse_squares()),
        depth(StagePass::depth(domain, domain.split(), 2, deepest)) {}

  PetscErrorCode prepare(GhostExchange &exchange, Pass *pass) const {
    PetscFunctionBeginUser;
    SuperTimeStepping &work = pass->work;
    std::vector<GhostUpdate> read{
        {pass->starts ? &work.rate : &work.now, pass->starts ? depth : pass->depth, nullptr, false}};
    if (pass->starts && work.slope) read.push_back({&work.slope, depth, nullptr, false});
    if (!pass->starts && pass->depth > 2) read.push_back({&work.before, pass->depth - 1, nullptr, false});
    PetscCall(exchange.update_ghosts(read));
    PetscFunctionReturn(0);
  }

  // Sets the values that a stage reads beside its points `at` in the direction normal to its component: the given
  // velocity on an inflow boundary, and the mirror image about an open boundary.
  [[gnu::noinline]] static void beside_row(const Pass &pass, int s, int a, View w, const Segment &at) {
    const StageSides &sides = pass.sides;
    const Int3 &n = pass.domain.cells();
    double *row = w.row(at.j, at.k);
    const int place[3] = {0, at.j, at.k};
    for (const bool high : {false, true}) {
      const int face = high ? n[a] : 0, inside = high ? n[a] - 1 : 1;
      const std::ptrdiff_t outward = high ? w.stride(a) : -w.stride(a);
      if (sides.open[a][high] && a == 0) row[face + outward] = row[inside];
      if (sides.open[a][high] && a != 0 && place[a] == face)
        for (int i = at.i_begin; i < at.i_end; ++i) row[i + outward] = row[i - outward];
      const BoundaryCondition &side = pass.increments[s][a][high];
      const double more = side.given.value;
      if (!sides.fixed[a][high] || side.kind != BoundaryKind::inflow || more == 0) continue;
      if (a == 0) set_inflow_row(pass.domain, side, a, high, more, at, w);
      if (a != 0 && place[a] == inside) {
        Segment face_row = at;
        (a == 1 ? face_row.j : face_row.k) = face;
        set_inflow_row(pass.domain, side, a, high, more, face_row, w);
      }
    }
  }

  // Fills ghosts at the ends of a periodic x, and behind boundaries that are tangential to the component.
  template <int Dim>
  EULASTIC_INLINE void surround(const Pass &pass, int s, int a, View w, const Segment &at) const {
    const Int3 &n = pass.domain.cells();
    double *row = w.row(at.j, at.k);
    pass.sides.wrap(row);
    const int place[3] = {0, at.j, at.k};
    for (int d = 0; d < Dim; ++d)
      for (int high = 0; high < 2; ++high) {
        const int last = d == 0 ? place[0] : high ? n[d] - 1 : 0;
        if (a == d || !pass.sides.wall[d][high] || place[d] != last) continue;
        const std::ptrdiff_t outward = high ? w.stride(d) : -w.stride(d);
        const BoundaryCondition &side = pass.increments[s][d][high];
        const double twice = 2 * side.motion.velocity[a], sign = is_solid(side.kind) ? -1 : 1;
        if (d == 0) {
          double *inside = high ? row + n[0] - 1 : row;
          inside[outward] = twice + sign * inside[0];
        } else {
          double *ghost = row + outward;
#pragma omp simd
          for (int i = at.i_begin; i < at.i_end; ++i) ghost[i] = twice + sign * row[i];
        }
      }
    if (pass.sides.any_beside) beside_row(pass, s, a, w, at);
  }
  void prefetch_rows(const RowAhead &, int) const {}

  template <int Dim>
  EULASTIC_INLINE void row(const Pass &pass, int s, int a, const Field &from, View out, const Segment &row) const {
    stage_row(pass, s, a, row, from[a], kernels::RowLaplacian<Dim>(from[a], row, h), out);
  }
  double flops(const Box &box) const {
    return box.cell_count() * box.dimension() *
           (box.dimension() == 2 ? kernels::rkl_stage_flops_2d : kernels::rkl_stage_flops_3d);
  }
};

template <int Dim>
EULASTIC_INLINE void stress_stage(const Pass &pass, const Field &viscosity, int s, int a, const Segment &faces,
                                  int side, const Field &from, View out) {
  const auto stress = stress_on_row<Dim>(pass.domain, viscosity, from, a, faces.j, faces.k);
  if (side != 0)
    return stage_row(
        pass, s, a, faces, from[a], [=](int i) EULASTIC_BODY { return stress.force_on_open_boundary(i, side); }, out);
  stage_row(
      pass, s, a, faces, from[a], [=](int i) EULASTIC_BODY { return stress.force(i); }, out);
}

EULASTIC_CLONES void stress_stage_2d(const Pass &pass, const Field &viscosity, int s, int a, const Segment &faces,
                                     int side, const Field &from, View out) {
  stress_stage<2>(pass, viscosity, s, a, faces, side, from, out);
}
EULASTIC_CLONES void stress_stage_3d(const Pass &pass, const Field &viscosity, int s, int a, const Segment &faces,
                                     int side, const Field &from, View out) {
  stress_stage<3>(pass, viscosity, s, a, faces, side, from, out);
}

// div tau(W)/rho with variable viscosity, which needs two layers of ghosts including corners. Cut faces of rigid bodies
// have the viscosity of the fluid.
struct LocalStress {
  static constexpr bool couples = true;
  static constexpr int depth = 1;
  const double viscosity = 1, beside_rigid;
  const Box &box;
  LocalViscosity &local;

  LocalStress(const Box &b, const ViscousStep &step) : beside_rigid(step.viscosity), box(b), local(*step.local) {}

  PetscErrorCode prepare(GhostExchange &exchange, Pass *pass) {
    PetscFunctionBeginUser;
    if (pass->starts) PetscFunctionReturn(0);
    PetscCall(exchange.update_ghosts(pass->work.now, 2));
    fill_wall_ghosts_velocity(box, pass->increments[0], 0, pass->work.now, 2);
    compute_tangential_stress(box, pass->work.now, &local);
    PetscFunctionReturn(0);
  }
  template <int Dim>
  EULASTIC_INLINE void surround(const Pass &, int, int, View, const Segment &) const {}

  void prefetch_rows(const RowAhead &next, int a) const {
    prefetch(local.fields[a + 1].row(next.j, next.k + 1), box.cells()[0]);
    if (a == 0) prefetch(local.fields[0].row(next.j, next.k), box.cells()[0]);
    if (local.stressed.all().empty() || next.j >= box.cells()[1] || next.k >= box.cells()[2]) return;
    for (const Segment &piece : local.beside.row(next.j, next.k))
      for (const int c : {a, a + 3}) prefetch(local.stress[c].row(next.j, next.k + 1) + piece.i_begin, piece.size());
  }

  // The stress along surfaces is omitted on open boundaries.
  template <int Dim>
  void row(const Pass &pass, int s, int a, const Field &from, View out, const Segment &row) const {
    for_faces(box, a, row, [&](const Segment &faces, int side) {
      (Dim == 2 ? stress_stage_2d : stress_stage_3d)(pass, local.fields, s, a, faces, side, from, out);
      if (side == 0) add_tangential_force(box, local, pass.stage[s].viscous, a, faces, out.row(faces.j, faces.k));
    });
  }
  double flops(const Box &) const {
    const double force = box.dimension() == 2 ? kernels::viscous_force_flops_2d : kernels::viscous_force_flops_3d;
    return box.cell_count() * box.dimension() * (force + 9) + tangential_stress_flops(box, local);
  }
};

// Computes the first stage of component a: W_1, and M_0 with the force at the start of the step.
EULASTIC_CLONES void first_stage_row(const Pass &pass, int a, const Segment &row) {
  double *m = pass.work.rate[a].row(row.j, row.k), *out = pass.work.now[a].row(row.j, row.k);
  const double first = pass.first, half = pass.half;
  if (pass.has_slope(row)) {
    const double *slope = pass.work.slope[a].row(row.j, row.k);
#pragma omp simd
    for (int i = row.i_begin; i < row.i_end; ++i) m[i] = kernels::fma(half, slope[i], m[i]);
  }
#pragma omp simd
  for (int i = row.i_begin; i < row.i_end; ++i) out[i] = first * m[i];
}

// Computes one stage where there may be rigid bodies: rows inside bodies are skipped, and cut faces are computed
// separately.
template <int Dim, class Term>
EULASTIC_INLINE void stage_beside_rigid(const Pass &pass, const Term &term, int s, int a, const Field &from, View out,
                                        const Segment &row) {
  const RigidFaces::Row faces = pass.step.rigid ? pass.step.rigid->row(a, row.j, row.k) : RigidFaces::Row{};
  if (faces.all) return;
  if (faces.empty()) return term.template row<Dim>(pass, s, a, from, out, row);
  thread_local std::vector<double> held;
  const ConstView w = from[a];
  const double *slope = pass.has_slope(row) ? pass.work.slope[a].row(row.j, row.k) : nullptr;
  pass.rigid[s].hold(faces, Dim, a, row.i_begin, row.i_end, pass.stage[s], w.row(row.j, row.k), {1, w.sy, w.sz},
                     pass.work.rate[a].row(row.j, row.k), slope, out.row(row.j, row.k), &held);
  term.template row<Dim>(pass, s, a, from, out, row);
  RigidStage::release(faces, row.i_begin, row.i_end, held, out.row(row.j, row.k));
}

// Computes v* of component a.
EULASTIC_CLONES void end_row(const Pass &pass, int a, ConstView w, const Segment &row) {
  const double *increment = w.row(row.j, row.k), *v = pass.step.velocity[a].row(row.j, row.k);
  double *out = pass.velocity_star[a].row(row.j, row.k);
#pragma omp simd
  for (int i = row.i_begin; i < row.i_end; ++i) out[i] = increment[i] + v[i];
}

// Prefetches the data of row `next` of component a that earlier rows did not read or write.
template <class Term>
EULASTIC_INLINE void prefetch_rows(const Pass &pass, const Term &term, int stage, int a, const RowAhead &next) {
  const auto ask = [&](const Field &field, int k) { prefetch(field[a].row(next.j, k), pass.domain.cells()[0]); };
  const SuperTimeStepping &work = pass.work;
  const int s = stage - pass.starts;
  if (stage == 0) {
    ask(work.now, s < 0 ? next.k : next.k + 1);
    ask(work.rate, next.k);
    if (work.slope) ask(work.slope, next.k);
  }
  if (s == 0) ask(work.before, next.k);
  if (s == 0) term.prefetch_rows(next, a);
  if (pass.ends && s == pass.depth - 1) ask(pass.step.velocity, next.k);
}

template <int Dim, class Term>
EULASTIC_INLINE void stages_of_task(const Pass &pass, const Term &term, const StagePass &order,
                                    const StagePass::Task &task) {
  const Int3 n = pass.domain.cells();
  const StageSides &sides = pass.sides;
  const int a_begin = Term::couples ? 0 : task.field, a_end = Term::couples ? Dim : task.field + 1;
  order.for_rows<Dim>(task, [&](int stage, Segment row, int j_end) EULASTIC_BODY {
    const int s = stage - pass.starts;  // -1: stage 1, W_1
    Field &from = s % 2 ? pass.work.before : pass.work.now, &to = s % 2 ? pass.work.now : pass.work.before;
    const int first = row.j, i_end = row.i_end;
    for (; row.j < j_end; ++row.j)
      for (int a = a_begin; a < a_end; ++a) {
        // Faces behind the last cells exist only for the component normal to the boundary.
        if (a != 1 && sides.beyond[1] && row.j == n[1]) continue;
        if (Dim == 3 && a != 2 && sides.beyond[2] && row.k == n[2]) continue;
        row.i_end = a == 0 ? i_end : i_end - sides.beyond[0];
        if (Dim == 3) prefetch_rows(pass, term, stage, a, RowAhead(first, j_end, row.j, row.k));
        const View out = to[a];
        if (!sides.holds(a, row)) {
          double *values = out.row(row.j, row.k);
          if (s < 0) {
            first_stage_row(pass, a, row);
          } else {
            if (pass.number + s == 2) std::fill(values + row.i_begin, values + row.i_end, 0.0);  // W_0
            term.template surround<Dim>(pass, s, a, from[a], row);
            stage_beside_rigid<Dim>(pass, term, s, a, from, out, row);
          }
          if (a == 0 && sides.fixed[0][0]) values[0] = 0;
        }
        if (pass.ends && s == pass.depth - 1) end_row(pass, a, out, row);
      }
  });
}

EULASTIC_CLONES void stages_2d(const Pass &pass, const UniformViscosity &term, const StagePass &order,
                               const StagePass::Task &task) {
  stages_of_task<2>(pass, term, order, task);
}
EULASTIC_CLONES void stages_3d(const Pass &pass, const UniformViscosity &term, const StagePass &order,
                               const StagePass::Task &task) {
  stages_of_task<3>(pass, term, order, task);
}
void stages_2d(const Pass &pass, const LocalStress &term, const StagePass &order, const StagePass::Task &task) {
  stages_of_task<2>(pass, term, order, task);
}
void stages_3d(const Pass &pass, const LocalStress &term, const StagePass &order, const StagePass::Task &task) {
  stages_of_task<3>(pass, term, order, task);
}

// Sets the normal velocity on boundaries to 0, except on open ones, where stages compute it.
void close_walls(const Box &box, Field &velocity) {
  for (int d = 0; d < box.dimension(); ++d)
    if (box.is_wall(d)) close_wall_faces(box, velocity[d], d);
}

template <class Term>
PetscErrorCode take_stages(const Domain &domain, GhostExchange &exchange, Term term, const ViscousStep &step,
                           SuperTimeStepping &work, Field &velocity_star) {
  PetscFunctionBeginUser;
  EventScope scope(Event::viscous);
  const int stages = step.stages, dim = domain.dimension();
  const StageSides sides(domain, step.sides);
  for (Field *field : {&work.rate, &work.slope, &work.now, &work.before})
    if (*field) close_walls(domain, *field);
  const std::vector<double> weights = step.rigid ? rkl_mean_weights(stages) : std::vector<double>();
  Pass pass{domain,         step, sides, work, velocity_star, 2, 0, true, false, rkl_first_step(stages, step.dt),
            -0.5 * step.dt, {},   {},    {}};
  for (; !pass.ends; pass.starts = false) {
    // passes have nearly equal depths
    const int left = stages - pass.number + 1, passes = (left + term.depth - 1) / term.depth;
    pass.depth = passes == 0 || (Term::couples && pass.starts) ? 0 : (left + passes - 1) / passes;
    pass.ends = pass.depth == left;
    pass.rigid.clear();
    for (int s = 0; s < pass.depth; ++s) {
      const int number = pass.number + s;
      const double reached = step.time + rkl_stage_time(number - 1, stages) * step.dt;
      pass.stage[s] = rkl_stage_coefficients(number, stages, step.dt, term.viscosity);
      pass.increments[s] = sides_of_increment(step.sides, step.time, reached);
      if (step.rigid)
        pass.rigid.emplace_back(*step.rigid, term.beside_rigid, step.time, reached, weights[number], step.means);
    }
    PetscCall(term.prepare(exchange, &pass));
    const StagePass order(domain, sides, pass.depth + pass.starts, Term::couples ? 1 : dim);
    order.for_tasks([&](const StagePass::Task &task) {
      if (dim == 2)
        stages_2d(pass, term, order, task);
      else
        stages_3d(pass, term, order, task);
    });
    if (pass.depth % 2) work.now.swap(work.before);
    pass.number += pass.depth;
  }
  scope.flops((stages - 1) * term.flops(domain) + domain.cell_count() * dim * 3);
  PetscFunctionReturn(0);
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

BoundaryConditions sides_of_increment(const BoundaryConditions &box_sides, double from, double to) {
  BoundaryConditions sides = box_sides;
  for (std::size_t d = 0; d < 3; ++d)
    for (std::size_t side = 0; side < 2; ++side) {
      const Real3 u = box_sides[d][side].motion.at(from), v = box_sides[d][side].motion.at(to);
      sides[d][side].motion = {{v[0] - u[0], v[1] - u[1], v[2] - u[2]}, 0, 0};
      sides[d][side].given = {box_sides[d][side].given.at(to) - box_sides[d][side].given.at(from), 0, 0, {}};
      sides[d][side].fed.reset();
    }
  return sides;
}

int rkl_stages(double dt, double dt_explicit) {
  if (!(dt_explicit > 0) || std::isinf(dt_explicit)) return 3;
  const double s = std::ceil(0.5 * (std::sqrt(9 + 16 * dt / dt_explicit) - 1) - 1e-9);
  const int stages = s < 3 ? 3 : static_cast<int>(std::fmin(s, 1e6));
  return stages % 2 ? stages : stages + 1;
}

PetscErrorCode super_time_step(const Domain &domain, GhostExchange &exchange, const ViscousStep &step,
                               SuperTimeStepping &work, Field &velocity_star) {
  PetscFunctionBeginUser;
  if (step.local)
    PetscCall(take_stages(domain, exchange, LocalStress(domain, step), step, work, velocity_star));
  else
    PetscCall(take_stages(domain, exchange, UniformViscosity(domain, step), step, work, velocity_star));
  PetscFunctionReturn(0);
}

}  // namespace eulastic
