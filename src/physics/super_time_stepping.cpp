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
  return {mu, nu, mu_tilde * dt * viscosity, (mu_tilde + gamma_tilde) * dt, mu_tilde * dt * stage_time(j - 1, stages) * dt};
}

// The part of every row that any phase stresses, whole vectors where the row is long enough.
std::vector<Segment> stressed_parts(const Grid &grid, const std::vector<Phase> *phases) {
  std::vector<Segment> parts = grid.rows();
  for (Segment &part : parts) {
    const int cells = part.i_end;
    int begin = cells, end = 0;
    for (std::size_t p = 0; phases && p < phases->size(); ++p) {
      const ActiveSegments::Range range = (*phases)[p].stressed.row(part.j, part.k);
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
  const FieldBlock *now, *rate, *slope;
  const std::vector<Segment> *stressed;  // one part per row; slope is read there
  FieldBlock *before;
};

template <int Dim>
EULASTIC_INLINE void stage_rows(const Grid &grid, const kernels::RklStage &c, const double *second,
                                const StageFields &f) {
  const int n = grid.owned()[0];
  for (int a = 0; a < Dim; ++a) {
    const ConstView w = (*f.now)[a], m = (*f.rate)[a];
    const View out = (*f.before)[a];
    for (const Segment &part : *f.stressed) {
      const int j = part.j, k = part.k;
      if (part.size() == 0) {
        kernels::rkl_stage<Dim, false>({0, n, j, k}, c, w, m, m, second, out);
        continue;
      }
      kernels::rkl_stage<Dim, false>({0, part.i_begin, j, k}, c, w, m, m, second, out);
      kernels::rkl_stage<Dim, true>(part, c, w, m, (*f.slope)[a], second, out);
      kernels::rkl_stage<Dim, false>({part.i_end, n, j, k}, c, w, m, m, second, out);
    }
  }
}

EULASTIC_CLONES void stage_2d(const Grid &g, const kernels::RklStage &c, const double *second, const StageFields &f) {
  stage_rows<2>(g, c, second, f);
}
EULASTIC_CLONES void stage_3d(const Grid &g, const kernels::RklStage &c, const double *second, const StageFields &f) {
  stage_rows<3>(g, c, second, f);
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

void clear(const Grid &grid, FieldBlock &block) {
  const Int3 n = grid.owned();
  for (int c = 0; c < block.count(); ++c)
    for (int k = 0; k < n[2]; ++k)
      for (int j = 0; j < n[1]; ++j) {
        double *row = block[c].row(j, k);
        for (int i = 0; i < n[0]; ++i) row[i] = 0;
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
  double second[3];
  for (int d = 0; d < 3; ++d) second[d] = 1 / (grid.spacing()[d] * grid.spacing()[d]);
  const double first = stages == 1 ? 1 : weight(1) * 4. / (double(stages) * stages + stages - 2);  // mu~_1
  if (work.slope) scale_add(grid, -0.5 * dt, work.slope, &work.rate, work.rate);  // the force at the start
  scale_add(grid, first * dt, work.rate, nullptr, work.now);
  if (stages > 1) clear(grid, work.before);
  const std::vector<Segment> stressed = stressed_parts(grid, work.slope ? &phases : nullptr);
  for (int j = 2; j <= stages; ++j) {
    PetscCall(exchange.update(work.now, 1));
    fill_wall_ghosts_velocity_change(grid, walls, time, time + stage_time(j - 1, stages) * dt, work.now, 1);
    const kernels::RklStage c = stage_coefficients(j, stages, dt, kinematic_viscosity);
    (grid.dimension() == 2 ? stage_2d : stage_3d)(
        grid, c, second, {&work.now, &work.rate, &work.slope, &stressed, &work.before});
    work.now.swap(work.before);
  }
  scale_add(grid, 1, work.now, &velocity, velocity_star);
  scope.flops(grid.owned_count() * grid.dimension() *
              ((stages - 1) * (grid.dimension() == 2 ? kernels::rkl_stage_flops_2d : kernels::rkl_stage_flops_3d) + 3));
  PetscFunctionReturn(0);
}

}  // namespace eulastic
