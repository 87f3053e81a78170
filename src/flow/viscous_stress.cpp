#include "flow/viscous_stress.hpp"

#include "base/events.hpp"
#include "flow/rkl_coefficients.hpp"
#include "flow/tangential_stress.hpp"
#include "flow/viscosity.hpp"
#include "grid/blocks.hpp"
#include "kernels/deviatoric_stress.hpp"
#include "rigid/rigid_surfaces.hpp"

#include <algorithm>

namespace eulastic {
namespace {

// Faces of a row; side: -1 on the low, 1 on the high open side of the box that they are normal to.
struct Faces : Segment {
  int side = 0;
};

template <int Dim>
EULASTIC_INLINE kernels::DeviatoricStress<Dim> stress_on_row(const Box &box, const Field &viscosity, const Field &v,
                                                             int a, int j, int k) {
  const int b = (a + 1) % Dim, c = Dim == 3 ? (a + 2) % 3 : b;
  const auto row = [=](const Field &block, int f) { return block[f].row(j, k); };
  const ConstView q = v[0];
  const Real3 &h = box.spacing();
  return {row(v, a),
          row(v, b),
          row(v, c),
          row(viscosity, 0),
          row(viscosity, viscosity_of_edge(Dim, a, b)),
          row(viscosity, viscosity_of_edge(Dim, a, c)),
          q.stride(a),
          q.stride(b),
          q.stride(c),
          1 / h[a],
          1 / h[b],
          1 / h[c]};
}

template <int Dim>
EULASTIC_INLINE void add_force(const Box &box, const Field &viscosity, double scale, const Field &velocity, Field &out,
                               int a, const Faces &row) {
  const kernels::DeviatoricStress<Dim> stress = stress_on_row<Dim>(box, viscosity, velocity, a, row.j, row.k);
  double *sum = out[a].row(row.j, row.k);
  if (row.side != 0) {
    for (int i = row.i_begin; i < row.i_end; ++i)
      sum[i] = kernels::fma(scale, stress.force_on_side(i, row.side), sum[i]);
    return;
  }
#pragma omp simd
  for (int i = row.i_begin; i < row.i_end; ++i) sum[i] = kernels::fma(scale, stress.force(i), sum[i]);
}

EULASTIC_CLONES void add_force_2d(const Box &box, const Field &viscosity, double scale, const Field &velocity,
                                  Field &out, int a, const Faces &row) {
  add_force<2>(box, viscosity, scale, velocity, out, a, row);
}
EULASTIC_CLONES void add_force_3d(const Box &box, const Field &viscosity, double scale, const Field &velocity,
                                  Field &out, int a, const Faces &row) {
  add_force<3>(box, viscosity, scale, velocity, out, a, row);
}

struct StageTerms {
  const Field *viscosity, *rate, *slope;  // the latter: null without
  const Field *now;                       // W_j-1
  Field *before;                          // W_j-2, which gets W_j
  kernels::RklStage c;
  bool second;  // W_0 = 0
};

template <int Dim>
EULASTIC_INLINE void stage_row(const Box &box, const StageTerms &s, int a, const Faces &row) {
  const int j = row.j, k = row.k;
  const kernels::DeviatoricStress<Dim> stress = stress_on_row<Dim>(box, *s.viscosity, *s.now, a, j, k);
  const double *w = (*s.now)[a].row(j, k), *m = (*s.rate)[a].row(j, k);
  const double *m1 = s.slope ? (*s.slope)[a].row(j, k) : m;
  const double along_slope = s.slope ? s.c.slope : 0;
  const kernels::RklStage c = s.c;
  double *out = (*s.before)[a].row(j, k);
  if (s.second) std::fill(out + row.i_begin, out + row.i_end, 0.0);
  const auto stage = [=](int i, double force) {
    double sum = c.nu * out[i];
    sum = kernels::fma(c.mu, w[i], sum);
    sum = kernels::fma(c.rate, m[i], sum);
    sum = kernels::fma(along_slope, m1[i], sum);
    out[i] = kernels::fma(c.viscous, force, sum);
  };
  if (row.side != 0) {
    for (int i = row.i_begin; i < row.i_end; ++i) stage(i, stress.force_on_side(i, row.side));
    return;
  }
#pragma omp simd
  for (int i = row.i_begin; i < row.i_end; ++i) stage(i, stress.force(i));
}

EULASTIC_CLONES void stage_row_2d(const Box &box, const StageTerms &s, int a, const Faces &row) {
  stage_row<2>(box, s, a, row);
}
EULASTIC_CLONES void stage_row_3d(const Box &box, const StageTerms &s, int a, const Faces &row) {
  stage_row<3>(box, s, a, row);
}

// M_0 with the force of the start, and W_1.
EULASTIC_CLONES void first_row(const Segment &row, double half, const double *slope, double first, double *m,
                               double *w) {
  if (slope) {
#pragma omp simd
    for (int i = row.i_begin; i < row.i_end; ++i) m[i] = kernels::fma(half, slope[i], m[i]);
  }
#pragma omp simd
  for (int i = row.i_begin; i < row.i_end; ++i) w[i] = first * m[i];
}

EULASTIC_CLONES void end_row(const Segment &row, const double *increment, const double *v, double *out) {
#pragma omp simd
  for (int i = row.i_begin; i < row.i_end; ++i) out[i] = increment[i] + v[i];
}

// visit(component, faces) for all owned rows, and the faces of open sides that are no row's.
template <class Visit>
void for_velocity_rows(const Box &box, const Visit &visit) {
  const auto open_low = [&](int a) { return box.is_open(a, false) && box.touches_low(a); };
  const bool open[3] = {open_low(0), open_low(1), open_low(2)};
  in_row_parts(box, [&](const RowPart &part) {
    for_rows_in_blocks(part, [&](int j, int k) {
      for (int a = 0; a < box.dimension(); ++a) {
        const int first = a == 0 && open[0] ? 1 : 0;
        if (first > 0) visit(a, Faces{{0, first, j, k}, -1});
        visit(a, Faces{{first, box.cells()[0], j, k}, a > 0 && open[a] && (a == 1 ? j : k) == 0 ? -1 : 0});
      }
    });
  });
  for (int a = 0; a < box.dimension(); ++a)
    for (const Segment &faces : box.open_high_faces(a)) visit(a, Faces{faces, 1});
}

// What a stage reads of the row that comes RowAhead::rows later: of what its stencil reads, the row ahead of it.
void prefetch_ahead(const Box &box, const LocalViscosity &viscosity, const StageTerms &s, int a, int j, int k) {
  if (box.dimension() == 2) return;
  const int n = box.cells()[0], begin = j / block_rows * block_rows, end = std::min(begin + block_rows, box.cells()[1]);
  const RowAhead next(begin, end, j, k);
  prefetch((*s.now)[a].row(next.j, next.k + 1), n);
  prefetch((*s.rate)[a].row(next.j, next.k), n);
  prefetch((*s.before)[a].row(next.j, next.k), n);
  if (s.slope) prefetch((*s.slope)[a].row(next.j, next.k), n);
  prefetch((*s.viscosity)[a + 1].row(next.j, next.k + 1), n);
  if (a == 0) prefetch((*s.viscosity)[0].row(next.j, next.k), n);
  if (viscosity.stressed.all().empty() || next.k >= box.cells()[2]) return;
  for (const Segment &piece : viscosity.beside.row(next.j, next.k))
    for (const int c : {a, a + 3}) prefetch(viscosity.stress[c].row(next.j, next.k + 1) + piece.i_begin, piece.size());
}

// Walls move, and more comes in, by that from one time to another.
BoxSides sides_of_increment(const BoxSides &box_sides, double from, double to) {
  BoxSides sides = box_sides;
  for (std::size_t d = 0; d < 3; ++d)
    for (std::size_t side = 0; side < 2; ++side) {
      const Real3 u = box_sides[d][side].motion.at(from), v = box_sides[d][side].motion.at(to);
      sides[d][side].motion = {{v[0] - u[0], v[1] - u[1], v[2] - u[2]}, 0, 0};
      sides[d][side].given = {box_sides[d][side].given.at(to) - box_sides[d][side].given.at(from), 0, 0, {}};
      sides[d][side].fed.reset();
    }
  return sides;
}

void close_walls(const Box &box, Field &velocity) {
  for (int d = 0; d < box.dimension(); ++d)
    if (box.is_wall(d)) close_wall_faces(box, velocity[d], d);
}

double force_flops(const Box &box) {
  return box.dimension() == 2 ? kernels::viscous_force_flops_2d : kernels::viscous_force_flops_3d;
}

EULASTIC_CLONES void rotate_row(int n, double factor, const double *viscosity, const double *D, double *p) {
#pragma omp simd
  for (int i = -1; i < n + 1; ++i) p[i] = kernels::fma(-factor * viscosity[i], D[i], p[i]);
}

}  // namespace

PetscErrorCode add_viscous_force(const Box &box, LocalViscosity &viscosity, double scale, const Field &velocity,
                                 Field &out) {
  PetscFunctionBeginUser;
  VerbScope scope(Verb::viscous);
  find_tangential_stress(box, velocity, &viscosity);
  for_velocity_rows(box, [&](int a, const Faces &row) {
    (box.dimension() == 2 ? add_force_2d : add_force_3d)(box, viscosity.fields, scale, velocity, out, a, row);
    if (row.side == 0) add_tangential_force(box, viscosity, scale, a, row, out[a].row(row.j, row.k));
  });
  scope.flops(box.cell_count() * box.dimension() * (force_flops(box) + 2) + tangential_stress_flops(box, viscosity));
  PetscFunctionReturn(0);
}

PetscErrorCode super_time_step(const Box &box, GhostExchange &exchange, const BoxSides &box_sides,
                               LocalViscosity &viscosity, double time, double dt, int stages, const Field &velocity,
                               SuperTimeStepping &work, Field &velocity_star, const RigidFaces *rigid,
                               double viscosity_beside_rigid, RigidMeans *means) {
  PetscFunctionBeginUser;
  VerbScope scope(Verb::viscous);
  const double first = rkl_first_step(stages, dt);
  const Field *slope = work.slope ? &work.slope : nullptr;
  for (int d = 0; slope && d < box.dimension(); ++d)  // bodies do not come to open sides
    for (const Segment &face : box.open_high_faces(d)) {
      double *row = work.slope[d].row(face.j, face.k);
      std::fill(row + face.i_begin, row + face.i_end, 0.0);
    }
  for_velocity_rows(box, [&](int a, const Faces &row) {
    first_row(row, -0.5 * dt, slope ? (*slope)[a].row(row.j, row.k) : nullptr, first, work.rate[a].row(row.j, row.k),
              work.now[a].row(row.j, row.k));
  });
  const std::vector<double> weights = rigid ? rkl_mean_weights(stages) : std::vector<double>();
  for (int j = 2; j <= stages; ++j) {
    PetscCall(exchange.update_ghosts(work.now, 2));
    const double reached = time + rkl_stage_time(j - 1, stages) * dt;
    fill_wall_ghosts_velocity(box, sides_of_increment(box_sides, time, reached), 0, work.now, 2);
    find_tangential_stress(box, work.now, &viscosity);
    const StageTerms stage{&viscosity.fields,
                           &work.rate,
                           slope,
                           &work.now,
                           &work.before,
                           rkl_stage_coefficients(j, stages, dt, 1),
                           j == 2};
    std::unique_ptr<RigidStage> beside;
    if (rigid) beside = std::make_unique<RigidStage>(*rigid, viscosity_beside_rigid, time, reached, weights[j], means);
    for_velocity_rows(box, [&](int a, const Faces &row) {
      if (row.j < box.cells()[1] && row.k < box.cells()[2]) prefetch_ahead(box, viscosity, stage, a, row.j, row.k);
      const RigidFaces::Row faces = rigid ? rigid->row(a, row.j, row.k) : RigidFaces::Row{};
      if (faces.all) return;
      thread_local std::vector<double> held;
      double *out = work.before[a].row(row.j, row.k);
      if (!faces.empty()) {
        if (j == 2) std::fill(out + row.i_begin, out + row.i_end, 0.0);
        const ConstView w = work.now[a];
        beside->hold(faces, box.dimension(), a, row.i_begin, row.i_end, stage.c, w.row(row.j, row.k), {1, w.sy, w.sz},
                     work.rate[a].row(row.j, row.k), slope ? (*slope)[a].row(row.j, row.k) : nullptr, out, &held);
      }
      (box.dimension() == 2 ? stage_row_2d : stage_row_3d)(box, stage, a, row);
      if (row.side == 0)
        add_tangential_force(box, viscosity, stage.c.viscous, a, row, out);  // bodies do not come to open sides
      if (!faces.empty()) RigidStage::release(faces, row.i_begin, row.i_end, held, out);
    });
    work.now.swap(work.before);
  }
  close_walls(box, work.now);
  for_velocity_rows(box, [&](int a, const Faces &row) {
    end_row(row, work.now[a].row(row.j, row.k), velocity[a].row(row.j, row.k), velocity_star[a].row(row.j, row.k));
  });
  scope.flops(box.cell_count() * box.dimension() * ((stages - 1) * (force_flops(box) + 9) + 3) +
              (stages - 1) * tangential_stress_flops(box, viscosity));
  PetscFunctionReturn(0);
}

PetscErrorCode rotate_pressure(const Box &box, const Field &viscosity, double factor, const Field &divergence,
                               Field &pressure) {
  PetscFunctionBeginUser;
  VerbScope scope(Verb::correction);
  in_row_parts(box, [&](const RowPart &owned) {
    const RowPart part = owned.with_ghosts(box);
    for (int k = part.k_begin; k < part.k_end; ++k)
      for (int j = part.j_begin; j < part.j_end; ++j)
        rotate_row(box.cells()[0], factor, viscosity[0].row(j, k), divergence[0].row(j, k), pressure[0].row(j, k));
  });
  scope.flops(box.cell_count() * 3);
  PetscFunctionReturn(0);
}

}  // namespace eulastic
