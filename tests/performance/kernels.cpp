// Kernels alone, row by row on a block of 64 x 16 x 16 cells that stays in the caches.
#include "../support/advection.hpp"
#include "../support/scene.hpp"
#include "kernels/elastic.hpp"
#include "kernels/momentum.hpp"
#include "kernels/poisson.hpp"
#include "kernels/super_time_stepping.hpp"
#include "kernels/upper_convected.hpp"
#include "machine.hpp"

#include <vector>

using namespace eulastic;

namespace {

struct Block {
  Domain domain;
  Field fields;
  std::vector<Segment> rows;
  std::vector<double> rate, carried[3];
  double inverse[3]{64, 16, 16};
  kernels::Directions directions{};

  Block() {
    GridSpec spec;
    spec.cells = {64, 16, 16};
    (void)domain.create(PETSC_COMM_SELF, spec);
    fields = Field(domain, 10);
    for (std::size_t i = 0; i < fields.bytes() / sizeof(double); ++i) fields.data()[i] = 1 + 0.1 * std::sin(0.37 * i);
    rows = domain.rows();
    rate.resize(64);
    for (auto &row : carried)
      for (int i = 0; i < 64; ++i) row.push_back(std::sin(0.9 * i));
    directions = {1, fields[0].sy, fields[0].sz, 64, 16, 16};
  }
};

EULASTIC_CLONES void carry(Block &b) {
  for (const Segment &s : b.rows)
    for (int d = 0; d < 3; ++d) kernels::average_velocity(s, b.fields[d], d, at_face[0].data(), 3, b.carried[d].data());
}

EULASTIC_CLONES void weno5(Block &b) {
  const double *velocity[3] = {b.carried[0].data(), b.carried[1].data(), b.carried[2].data()};
  for (const Segment &s : b.rows) test::advection_rate<3>(s, b.fields[0], velocity, b.inverse, 1e-6, b.rate.data());
}

EULASTIC_CLONES void viscous(Block &b) {
  const InverseSquares h = b.domain.inverse_squares();
  for (const Segment &s : b.rows)
    kernels::fluid_rate<3>(s, b.rate.data(), b.fields[0], h, b.fields[3], 1, 64, 1, b.carried[0].data());
}

EULASTIC_CLONES void rkl_stage(Block &b) {
  const InverseSquares h = b.domain.inverse_squares();
  const kernels::RklStage stage{0.5, 0.3, 1e-6, 0.01, 0};
  for (const Segment &s : b.rows)
    kernels::rkl_stage<false>(s, stage, b.fields[0], b.fields[1], b.fields[1],
                              kernels::RowLaplacian<3>(b.fields[0], s, h), b.fields[2]);
}

// The sums of a sweep along D and the step before, whose Laplacian is D before - D; without what is done once a row.
EULASTIC_CLONES void sweep_sums(Block &b) {
  const InverseSquares h = b.domain.inverse_squares();
  const std::ptrdiff_t sy = b.fields[0].sy, sz = b.fields[0].sz;
  for (const Segment &s : b.rows) {
    const double *D = b.fields[0].row(s.j, s.k), *before = b.fields[1].row(s.j, s.k);
    double sum[7];
    kernels::lane_sums<7>(
        s.i_end, 0,
        [=](int i, auto add) EULASTIC_BODY {
          const double lap_D = kernels::laplacian<3>(D + i, sy, sz, h), lap_d = before[i] - D[i];
          add(0, D[i], D[i]);
          add(1, D[i], 1);
          add(2, D[i], lap_D);
          add(3, D[i], lap_d);
          add(4, lap_D, lap_D);
          add(5, lap_d, lap_D);
          add(6, lap_d, lap_d);
        },
        sum);
    b.rate[0] += sum[0] + sum[1] + sum[2] + sum[3] + sum[4] + sum[5] + sum[6];
  }
}

EULASTIC_CLONES void elastic(Block &b) {
  const std::ptrdiff_t stride[3] = {b.directions.a, b.directions.b, b.directions.c};
  const double *B[6];
  for (int c = 0; c < 6; ++c) B[c] = b.fields[4 + c].origin;
  for (const Segment &s : b.rows)
    kernels::elastic_force<3>(s, b.fields[3], B, stride, b.inverse, 0, kernels::NeoHookean{1}, kernels::SameViscosity{},
                              [to = b.fields[0].row(0, 0)](std::ptrdiff_t o, double f) EULASTIC_BODY { to[o] += f; });
}

EULASTIC_CLONES void stretch_diagonal(Block &b) {
  for (const Segment &s : b.rows) {
    const auto row = [&](int f) { return b.fields[f].row(s.j, s.k); };
    const double *xx = row(4), *xy = row(9), *xz = row(8), *u = row(0);
    const kernels::SameViscosity viscosity;
    double *rate = b.rate.data();
#pragma omp simd
    for (int i = 0; i < s.i_end; ++i)
      rate[i] += kernels::half_diagonal_stretch<3>(xx + i, xy + i, xz + i,
                                                   viscosity.shear<3>(u + i, nullptr, nullptr, nullptr), b.directions);
  }
}

EULASTIC_CLONES void stretch_shear(Block &b) {
  for (const Segment &s : b.rows) {
    const auto row = [&](int f) { return b.fields[f].row(s.j, s.k); };
    const double *xx = row(4), *yy = row(5), *xy = row(9), *yz = row(7), *xz = row(8), *u = row(0), *v = row(1);
    const double *w = row(2);
    const kernels::SameViscosity viscosity;
    double *rate = b.rate.data();
#pragma omp simd
    for (int i = 0; i < s.i_end; ++i)
      rate[i] += kernels::shear_stretch<3>(xx + i, yy + i, xy + i, yz + i, xz + i,
                                           viscosity.shear<3>(u + i, v + i, w + i, nullptr), b.directions);
  }
}

void kernel(benchmark::State &state, void (*work)(Block &), double flops_per_cell) {
  Block block;
  const double cells = block.domain.cell_count() * performance::sum_over_ranks(1);  // a block on every rank
  performance::measure(state, {cells, 0, flops_per_cell}, [&] {
    std::fill(block.rate.begin(), block.rate.end(), 0.0);
    work(block);
    benchmark::DoNotOptimize(block.rate.data());
    return 0;
  });
}

BENCHMARK_CAPTURE(kernel, average_velocity, carry, 9)->Iterations(1000)->UseRealTime();
BENCHMARK_CAPTURE(kernel, weno5_advection, weno5, 3 * (kernels::weno5_flops + 3))->Iterations(1000)->UseRealTime();
BENCHMARK_CAPTURE(kernel, viscous_pressure, viscous, 3 * kernels::viscous_pressure_flops_per_direction + 5)
    ->Iterations(1000)
    ->UseRealTime();
BENCHMARK_CAPTURE(kernel, rkl_stage, rkl_stage, kernels::rkl_stage_flops_3d)->Iterations(1000)->UseRealTime();
BENCHMARK_CAPTURE(kernel, sweep_sums, sweep_sums, 13 + 1 + 14)->Iterations(1000)->UseRealTime();
BENCHMARK_CAPTURE(kernel, elastic_force, elastic, kernels::NeoHookean::flops(3))->Iterations(1000)->UseRealTime();
BENCHMARK_CAPTURE(kernel, stretch_diagonal, stretch_diagonal, kernels::stretch_diagonal_flops_3d)
    ->Iterations(1000)
    ->UseRealTime();
BENCHMARK_CAPTURE(kernel, stretch_shear, stretch_shear, kernels::stretch_shear_flops_3d)
    ->Iterations(1000)
    ->UseRealTime();

}  // namespace
