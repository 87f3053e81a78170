// What the cores can do, measured right after every benchmark, as neighbours on a machine change it within minutes; and
// how results are reported.
// Under mpiexec all ranks run the same benchmarks together, and everything counted is the sum over them and their
// threads.
#pragma once

#include "base/petsc.hpp"

#include <benchmark/benchmark.h>

#include <algorithm>

namespace eulastic::performance {

/// Sums over all cores, measured by all at the same time, best of several.
struct Machine {
  double peak;   ///< fused multiply-adds on registers, flops per second (two per fma)
  double triad;  ///< a = b + s c on arrays far larger than the caches, bytes per second; an element counts 32: the line
                 ///< of a is read before it is written (write-allocate)
};
Machine measure_machine();
/// Sum over all ranks.
double sum_over_ranks(double value);

/// What one call has to do, in the open.
struct Work {
  double cells;      ///< cell updates (or cells x stages) of all ranks together
  double bytes = 0;  ///< per cell: read 8, write 16, update in place 16 a value; 0 = in the caches
  double flops = 0;  ///< per cell; 0 = what the call logs to PETSc
};

/// Calls as many times as make about 4 million cells; the same on every rank.
inline int calls(double cells) { return std::max(1, static_cast<int>(4.2e6 / cells)); }

/// Times `verb` and reports ns per cell; from the flops GFlop/s and the share of the peak; from the bytes GB/s and the
/// share of the triad; from both the time predicted by the slower of the two.
template <class Event>
void measure(benchmark::State &state, const Work &work, Event verb) {
  bool failed = verb() != 0;  // warms up
  PetscLogDouble before = 0, after = 0;
  (void)PetscGetFlops(&before);
  (void)MPI_Barrier(PETSC_COMM_WORLD);
  for (auto _ : state) {
    failed = failed || verb() != 0;
    benchmark::ClobberMemory();
    (void)MPI_Barrier(PETSC_COMM_WORLD);  // the slowest rank counts
  }
  (void)PetscGetFlops(&after);
  if (failed) return state.SkipWithError("failed");
  const double iterations = static_cast<double>(state.iterations());
  const double flops = work.flops > 0 ? work.flops : sum_over_ranks(after - before) / (iterations * work.cells);
  const Machine machine = measure_machine();
  using benchmark::Counter;
  const auto per_second = [](double n) { return Counter(n, Counter::kIsIterationInvariantRate); };
  state.counters["ns_per_cell"] = Counter(1e-9 * work.cells, Counter::kIsIterationInvariantRate | Counter::kInvert);
  state.counters["flops_per_cell"] = Counter(flops);
  state.counters["GFlops"] = per_second(1e-9 * flops * work.cells);
  state.counters["peak"] = Counter(1e-9 * machine.peak);
  state.counters["triad"] = Counter(1e-9 * machine.triad);
  state.counters["of_peak"] = per_second(flops * work.cells / machine.peak);
  const double computing = flops / machine.peak, moving = work.bytes / machine.triad;
  if (work.bytes > 0) {
    state.counters["bytes_per_cell"] = Counter(work.bytes);
    state.counters["GBytes"] = per_second(1e-9 * work.bytes * work.cells);
    state.counters["of_triad"] = per_second(moving * work.cells);
  }
  state.counters["predicted_ns"] = Counter(1e9 * std::max(computing, moving));
}

}  // namespace eulastic::performance
