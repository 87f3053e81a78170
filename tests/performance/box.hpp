// Scenes for timing, shared by all ranks of the program: a channel with walls in y and cubic cells.
#pragma once

#include "../support/scene.hpp"
#include "machine.hpp"

namespace eulastic::performance {

/// Nothing; red blood cells, one per 32 x 64 x 64 cells as in the paper; a solid everywhere.
enum class Filling { none, cells, all };

struct FilledBox {
  test::Scene scene;
  double dt = 0;

  /// h = 21.12/128 (um), so 128^3 cells are the box of options/channel_rbc.opts.
  PetscErrorCode create(const Int3 &cells, Filling filling, const Method &method);
};

/// The box asked for last stays, so that repetitions share it. Null where it cannot be made. Collective.
FilledBox *box(const Int3 &cells, Filling filling, const Method &method);
/// Before PetscFinalize().
void forget_box();

/// The sizes of the paper's Table 1, as arguments of benchmarks.
inline Int3 cells_of(const benchmark::State &state) {
  return {int(state.range(0)), int(state.range(1)), int(state.range(2))};
}
inline void set_size(benchmark::internal::Benchmark *b, int nx, int ny, int nz) {
  b->Args({nx, ny, nz})->Iterations(calls(double(nx) * ny * nz))->UseRealTime()->Unit(benchmark::kMillisecond);
}
inline void cube_64(benchmark::internal::Benchmark *b) { set_size(b, 64, 64, 64); }
inline void cube_128(benchmark::internal::Benchmark *b) { set_size(b, 128, 128, 128); }
inline void long_box(benchmark::internal::Benchmark *b) { set_size(b, 512, 128, 128); }

}  // namespace eulastic::performance
