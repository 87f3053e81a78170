#include "physics/super_time_stepping.hpp"

#include "base/events.hpp"
#include "grid/threads.hpp"
#include "kernels/super_time_stepping.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <thread>

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

// Stages j ... j + depth - 1, each one slice (a plane, in 2-D a row) behind the stage before it. A stage is needed at
// the owned points and, for those after it, in layers around them, which are computed again instead of exchanged.
struct Pass {
  int depth;
  kernels::RklStage stage[deepest];
  double twice_wall[deepest][3][3][2];  // of component a of what the stage reads, at a wall of direction d: 2 U
};

// Where a rank ends: an x that is not split wraps around within the row.
struct Sides {
  bool wraps_x;
  bool wall[3][2];
  bool alone[3];  // no layers to be computed again

  explicit Sides(const Grid &grid) {
    wraps_x = grid.wraps_x();
    for (int d = 0; d < 3; ++d) {
      wall[d][0] = grid.touches_low(d);
      wall[d][1] = grid.touches_high(d);
      alone[d] = d >= grid.dimension() || (d == 0 && wraps_x);
    }
  }
  int low(int d, int layers) const { return alone[d] || wall[d][0] ? 0 : layers; }
  int high(int d, int layers) const { return alone[d] || wall[d][1] ? 0 : layers; }
};

// The most stages of a pass: the ghosts must reach, and what is computed again stay below a quarter of the first stage.
// Every rank finds the same.
int depth_of_passes(const Grid &grid, const Sides &sides) {
  int depth = 2;
  for (int more = 3; more <= std::min(deepest, grid.spec().ghosts); ++more) {
    double share = 1;
    for (int d = 0; d < grid.dimension(); ++d)
      if (!sides.alone[d] && (grid.processors(d) > 1 || grid.boundary(d) == Boundary::periodic))
        share *= 1 + 2.0 * (more - 1) * grid.processors(d) / grid.cells()[d];
    if (share < 1.25) depth = more;
  }
  return depth;
}

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

// What a stage reads beside its points `row`, made when it comes to them: across a periodic x and behind walls.
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
      if (!sides.wall[d][side] || place[d] != last) continue;
      const std::ptrdiff_t s = w.stride(d);
      const double twice = twice_wall[d][side];
      if (d == 0) {
        double *inside = side ? row + n[0] - 1 : row;
        (a == d && !side ? inside[0] : inside[side ? 1 : -1]) = a == d ? 0 : twice - inside[0];
      } else if (a == d) {
        double *face = side ? row + s : row;
        for (int i = at.i_begin; i < at.i_end; ++i) face[i] = 0;
      } else {
        double *ghost = side ? row + s : row - s;
#pragma omp simd
        for (int i = at.i_begin; i < at.i_end; ++i) ghost[i] = twice - row[i];
      }
    }
}

// A block of rows of a component in one pass; in 2-D all rows.
struct alignas(64) Block {
  int component, j_begin;
  const std::atomic<int> *below = nullptr;  // slices that the block of lower rows has done; null: there is none
  std::atomic<int> done{};
};

// The first slice of a pass, of the first stage, and one past the last slice of its last stage.
int first_slice(const Grid &grid, const Sides &sides, int depth) { return -sides.low(grid.dimension() - 1, depth - 1); }
int end_slice(const Grid &grid, int depth) { return grid.owned()[grid.dimension() - 1] + depth - 1; }

// In the order in which they are done: a block of a component reads what the one below it has written, and may follow
// it slice by slice: neither writes what the other has not yet read then.
std::vector<Block> blocks_of(const Grid &grid, const Sides &sides, int depth) {
  const bool flat = grid.dimension() == 2;
  const int begin = flat ? 0 : -sides.low(1, depth - 1), end = flat ? 1 : grid.owned()[1] + depth - 1;
  const int count = (end - begin + kernels::block_rows - 1) / kernels::block_rows;
  std::vector<Block> blocks(std::size_t(count) * grid.dimension());
  for (int a = 0; a < grid.dimension(); ++a)
    for (int b = 0; b < count; ++b) {
      Block &block = blocks[a * count + b];
      block.component = a;
      block.j_begin = begin + b * kernels::block_rows;
      block.done = first_slice(grid, sides, depth);
      if (b > 0) block.below = &blocks[a * count + b - 1].done;
    }
  return blocks;
}

// Stages alternate: the first reads W_j-1 in `now` and writes W_j over W_j-2 in `before`, the next the other way. In
// 3-D every stage is a row behind the one before it too: what they have in common stays in the second-level cache. The
// first asks for the next plane.
template <int Dim>
EULASTIC_INLINE void stages_of_block(const Grid &grid, const Pass &pass, const InverseSquares &h, const Sides &sides,
                                     const StageFields &f, Block &block) {
  constexpr int last = Dim - 1;
  const Int3 n = grid.owned();
  const int a = block.component;
  for (int first = block.done; first < end_slice(grid, pass.depth); ++first) {
    while (block.below && block.below->load(std::memory_order_acquire) <= first) std::this_thread::yield();
    for (int s = 0; s < pass.depth; ++s) {
      const int slice = first - s, layers = pass.depth - 1 - s;
      if (slice < -sides.low(last, layers) || slice >= n[last] + sides.high(last, layers)) continue;
      const View w = (*(s % 2 ? f.before : f.now))[a], out = (*(s % 2 ? f.now : f.before))[a];
      const int j_begin = Dim == 3 ? std::max(block.j_begin - s, -sides.low(1, layers)) : slice;
      const int j_end =
          Dim == 3 ? std::min(block.j_begin + kernels::block_rows - s, n[1] + sides.high(1, layers)) : slice + 1;
      for (int j = j_begin; j < j_end; ++j) {
        const Segment row{-sides.low(0, layers), n[0] + sides.high(0, layers), j, Dim == 3 ? slice : 0};
        if (Dim == 3 && s == 0) {
          kernels::prefetch(w.row(j, slice + 2), n[0]);
          kernels::prefetch(out.row(j, slice + 1), n[0]);
          kernels::prefetch((*f.rate)[a].row(j, slice + 1), n[0]);
          if (f.stressed) kernels::prefetch((*f.slope)[a].row(j, slice + 1), n[0]);
        }
        surround_row<Dim>(n, sides, pass.twice_wall[s][a], a, w, row);
        stage_row<Dim>(n, pass.stage[s], h, f, a, w, out, row);
      }
    }
    block.done.store(first + 1, std::memory_order_release);
  }
}

EULASTIC_CLONES void stages_2d(const Grid &grid, const Pass &pass, const InverseSquares &h, const Sides &sides,
                               const StageFields &f, Block &block) {
  stages_of_block<2>(grid, pass, h, sides, f, block);
}
EULASTIC_CLONES void stages_3d(const Grid &grid, const Pass &pass, const InverseSquares &h, const Sides &sides,
                               const StageFields &f, Block &block) {
  stages_of_block<3>(grid, pass, h, sides, f, block);
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
  if (stages > 1) work.before.clear();
  const Sides sides(grid);
  const int depth = depth_of_passes(grid, sides);
  PetscCall(exchange.update_rows(work.rate, depth - 1));
  std::vector<char> stressed;
  if (work.slope) {
    PetscCall(exchange.update_rows(work.slope, depth - 1));
    stressed = stressed_rows(grid, phases);
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
    PetscCall(exchange.update_rows(work.now, pass.depth));
    if (j > 2 && pass.depth > 2) PetscCall(exchange.update_rows(work.before, pass.depth - 1));
    const StageFields fields{&work.rate, &work.slope, work.slope ? &stressed : nullptr, &work.now, &work.before};
    std::vector<Block> blocks = blocks_of(grid, sides, pass.depth);
    const auto advance = [&](int b) {
      (grid.dimension() == 2 ? stages_2d : stages_3d)(grid, pass, h, sides, fields, blocks[b]);
    };
    in_parallel(row_parts(grid), static_cast<int>(blocks.size()), advance);
    if (pass.depth % 2) work.now.swap(work.before);
  }
  scale_add(grid, 1, work.now, &velocity, velocity_star);
  scope.flops(grid.owned_count() * grid.dimension() *
              ((stages - 1) * (grid.dimension() == 2 ? kernels::rkl_stage_flops_2d : kernels::rkl_stage_flops_3d) + 3));
  PetscFunctionReturn(0);
}

}  // namespace eulastic
