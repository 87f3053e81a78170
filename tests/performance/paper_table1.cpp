// The parts of the step that the paper's Table 1 lists, on a solid everywhere. The loops are those of the step, less
// what the step does in the same pass.
#include "box.hpp"
#include "field/advection.hpp"
#include "flow/momentum.hpp"
#include "grid/blocks.hpp"
#include "grid/row_scratch.hpp"
#include "grid/threads.hpp"
#include "kernels/elastic.hpp"
#include "kernels/upper_convected.hpp"
#include "kernels/weno5.hpp"

using namespace eulastic;
using performance::FilledBox;

namespace {

struct Fields {
  const Domain &domain;
  const Field &velocity, &fraction, &tensor;
  Field &next;  // ten
  double dt;
  Real3 inverse;
};

// q - dt v.grad q of field f of `next`.
template <class Points>
EULASTIC_INLINE void move(const Fields &t, const Points &points, ConstView q, int f, const double *rate) {
  const double *now = q.origin, dt = t.dt;
  double *next = t.next[f].origin;
  kernels::for_points(points, q,
                      [=](std::ptrdiff_t o, int i) EULASTIC_BODY { next[o] = kernels::fma(dt, rate[i], now[o]); });
}

// Components of B at one location, `first` to `last` - 1.
EULASTIC_INLINE void move_tensor(const Fields &t, int block, int k, const Staggering &at, int first, int last) {
  alignas(64) double rate[kernels::Batch::points], carried[3][kernels::Batch::points];
  const double *const velocity[3] = {carried[0], carried[1], carried[2]};
  const Int3 n = t.domain.cells();
  const auto work = [&](kernels::Batch &batch) EULASTIC_BODY {
    for (int d = 0; d < 3; ++d) {
      const ConstView face = t.velocity[d];
      batch.ahead[0] = first == 0 ? face.origin + 2 * face.sz : nullptr;
      kernels::average_velocity(batch, face, d, at.data(), 3, carried[d]);
    }
    for (int c = first; c < last; ++c) {
      const ConstView q = t.tensor[c];
      batch.ahead[0] = q.origin + 4 * q.sz;
      batch.ahead[1] = t.next[4 + c].origin + q.sz;
      kernels::advection_rate<3>(batch, q, velocity, t.inverse.data(), 1e-6, rate);
      batch.ahead[0] = batch.ahead[1] = nullptr;
      move(t, batch, q, 4 + c, rate);
    }
  };
  kernels::Batch batch;
  for (int j = block; j < std::min(block + block_rows, n[1]); ++j)
    kernels::gather(batch, j * t.tensor[0].sy + k * t.tensor[0].sz, 0, n[0], work);
  work(batch);
}

// q - dt v.grad q of three velocities, phi and six components of B, each where it lives.
EULASTIC_CLONES void advect(const Fields &t, const RowPart &part, RowScratch &scratch) {
  double *rate = scratch.row(0);
  const int n = t.domain.cells()[0];
  const Field &v = t.velocity;
  for_rows_in_blocks(part, [&](int j, int k) EULASTIC_BODY {
    const Segment row{0, n, j, k};
    for (int a = 0; a < 3; ++a) {
      const RowsAhead ahead{{{v[a].row(j, k + 4), nullptr}, {t.next[a].row(j, k + 1), nullptr}, {}}, n};
      face_advection_rate(row, v, a, t.inverse.data(), 1e-6, ahead, rate);
      move(t, row, v[a], a, rate);
    }
  });
  for_rows_in_blocks(part, [&](int j, int k) EULASTIC_BODY {
    const Segment row{0, n, j, k};
    const ConstView q = t.fraction[0];
    const RowsAhead ahead{{{q.row(j, k + 4), nullptr},
                           {v[0].row(j, k + 2), v[1].row(j, k + 2)},
                           {v[2].row(j, k + 2), t.next[3].row(j, k + 1)}},
                          n};
    centre_advection_rate(row, q, v, t.inverse.data(), 1e-6, ahead, rate);
    move(t, row, q, 3, rate);
  });
  for (int block = part.j_begin; block < part.j_end; block += block_rows)
    for (int k = part.k_begin; k < part.k_end; ++k) {
      move_tensor(t, block, k, at_centre, 0, 3);
      for (int c = 0; c < 3; ++c) move_tensor(t, block, k, {c != 0, c != 1, c != 2}, 3 + c, 4 + c);
    }
}
// Averages to the faces 3 x 8, to the centres 6 twice, to the edges 3 x 12; ten updates.
constexpr double derivatives = 30, advection_flops = derivatives * (kernels::weno5_flops + 3) + 24 + 12 + 36 + 20;
constexpr double advection_bytes = 10 * (8 + 16) + 2 * 24;  // the velocities once more for phi and for B

// L.B + B.L^T into a row that stays in the first-level cache, as in the step.
EULASTIC_CLONES void stretch(const Fields &t, const RowPart &part, RowScratch &scratch) {
  double *rate = scratch.row(0);
  const ConstView v0 = t.velocity[0];
  const std::ptrdiff_t stride[3] = {1, v0.sy, v0.sz};
  for_rows_in_blocks(part, [&](int j, int k) EULASTIC_BODY {
    const Segment row{0, t.domain.cells()[0], j, k};
    for (int a = 0; a < 3; ++a) {
      const int b = (a + 1) % 3, c = (a + 2) % 3;
      const kernels::Directions d{stride[a], stride[b], stride[c], t.inverse[a], t.inverse[b], t.inverse[c]};
      // Of a and b; the edge component opposite to direction x is 3 + x.
      const double *aa = t.tensor[a].origin, *bb = t.tensor[b].origin, *ab = t.tensor[3 + c].origin;
      const double *bc = t.tensor[3 + a].origin, *ac = t.tensor[3 + b].origin;
      const double *va = t.velocity[a].origin, *vb = t.velocity[b].origin;
      kernels::for_points(row, v0, [=](std::ptrdiff_t o, int i) EULASTIC_BODY {
        rate[i] = 2 * kernels::half_diagonal_stretch<3>(aa + o, ab + o, ac + o,
                                                        kernels::MixtureShear{{va + o, nullptr, nullptr}}, d);
      });
      benchmark::DoNotOptimize(rate);
      kernels::for_points(row, v0, [=](std::ptrdiff_t o, int i) EULASTIC_BODY {
        rate[i] = kernels::shear_stretch<3>(aa + o, bb + o, ab + o, bc + o, ac + o,
                                            kernels::MixtureShear{{va + o, vb + o, nullptr}}, d);
      });
      benchmark::DoNotOptimize(rate);
    }
  });
}
constexpr double stretch_flops = 3 * (kernels::stretch_diagonal_flops_3d + kernels::stretch_shear_flops_3d);
constexpr double stretch_bytes = 9 * 8;
constexpr double elastic_bytes = 7 * 8 + 3 * 16;

template <class Task>
void part(benchmark::State &state, double bytes, double flops, Task task) {
  FilledBox *box =
      performance::box(performance::cells_of(state), performance::Filling::all, method_preset(MethodKind::classic));
  if (!box) return state.SkipWithError("no scene");
  const Domain &domain = box->scene.domain;
  State &now = box->scene.solver.state();
  Field next(domain, 10);
  const Real3 &h = domain.spacing();
  const Fields fields{domain, now.velocity, now.phases[0].fraction,        now.phases[0].tensor.field,
                      next,   box->dt,      {1 / h[0], 1 / h[1], 1 / h[2]}};
  performance::measure(state, {domain.domain_cell_count(), bytes, flops}, [&] { return task(fields, now.phases); });
}

void advection(benchmark::State &state) {
  part(state, advection_bytes, advection_flops, [](const Fields &fields, const auto &) {
    in_row_parts(fields.domain, [&](const RowPart &rows) {
      RowScratch scratch(fields.domain, 1);
      advect(fields, rows, scratch);
    });
    return 0;
  });
  state.counters["derivatives"] = derivatives;
}

void oldroyd_rate(benchmark::State &state) {
  part(state, stretch_bytes, stretch_flops, [](const Fields &fields, const auto &) {
    in_row_parts(fields.domain, [&](const RowPart &rows) {
      RowScratch scratch(fields.domain, 1);
      stretch(fields, rows, scratch);
    });
    return 0;
  });
}

// Stress and its divergence: one pass, no stress is stored.
void elastic_force(benchmark::State &state) {
  part(state, elastic_bytes, 3 * kernels::NeoHookean::flops(3),
       [](const Fields &fields, const std::vector<Phase> &phases) {
         return compute_elastic_force(fields.domain, 1, phases, fields.next);
       });
}

#define EULASTIC_PART(name)                      \
  BENCHMARK(name)->Apply(performance::cube_64);  \
  BENCHMARK(name)->Apply(performance::cube_128); \
  BENCHMARK(name)->Apply(performance::long_box)

EULASTIC_PART(advection);
EULASTIC_PART(oldroyd_rate);
EULASTIC_PART(elastic_force);

}  // namespace
