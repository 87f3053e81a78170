// What this core can do, measured in this process: the yardsticks of all benchmarks; and how results are reported.
#pragma once

#include "base/petsc.hpp"

#include <benchmark/benchmark.h>

namespace eulastic::performance {

/// Fused multiply-adds on registers, flops per second (two per fma); best of several, measured once.
double peak_flops();
/// a = b + s c on arrays far larger than the caches, bytes per second (24 per element); likewise.
double triad_bandwidth();

/// Runs `verb` and reports ns per cell and, from the flops that it logs or `flops` per call, GFlop/s and the share of
/// the peak; from `values`, the doubles per cell that it must read or write, the share of the triad.
template <class Verb>
void measure(benchmark::State &state, double cells, double values, double flops, Verb verb) {
  PetscLogDouble before = 0, after = 0;
  (void)PetscGetFlops(&before);
  for (auto _ : state) {
    if (verb() != 0) {
      state.SkipWithError("failed");
      return;
    }
    benchmark::ClobberMemory();
  }
  (void)PetscGetFlops(&after);
  const double done = flops > 0 ? flops * static_cast<double>(state.iterations()) : after - before;
  using benchmark::Counter;
  state.counters["ns_per_cell"] = Counter(1e-9 * cells, Counter::kIsIterationInvariantRate | Counter::kInvert);
  state.counters["flops_per_cell"] = Counter(done / cells, Counter::kAvgIterations);
  state.counters["GFlops"] = Counter(1e-9 * done, Counter::kIsRate);
  state.counters["of_peak"] = Counter(done / peak_flops(), Counter::kIsRate);
  if (values > 0)
    state.counters["of_triad"] = Counter(8 * values * cells / triad_bandwidth(), Counter::kIsIterationInvariantRate);
}

}  // namespace eulastic::performance
