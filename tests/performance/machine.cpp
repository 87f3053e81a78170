#include "machine.hpp"

#include "grid/threads.hpp"
#include "kernels/isa.hpp"

#include <algorithm>
#include <chrono>
#include <vector>

namespace eulastic::performance {
namespace {

constexpr int rounds = 20000;

// `Lanes` independent chains of fused multiply-adds: enough vectors to hide the latency, few enough for the registers.
template <int Lanes>
EULASTIC_INLINE void multiply_add(double *values) {
  double x[Lanes];
  for (int i = 0; i < Lanes; ++i) x[i] = values[i];
  for (int r = 0; r < rounds; ++r) {
#pragma omp simd
    for (int i = 0; i < Lanes; ++i) x[i] = kernels::fma(x[i], 0.999, 0.001);
  }
  for (int i = 0; i < Lanes; ++i) values[i] = x[i];
}
EULASTIC_CLONES void multiply_add_40(double *values) { multiply_add<40>(values); }
EULASTIC_CLONES void multiply_add_96(double *values) { multiply_add<96>(values); }

EULASTIC_CLONES void triad(std::ptrdiff_t n, double *a, const double *b, const double *c, double s) {
#pragma omp simd
  for (std::ptrdiff_t i = 0; i < n; ++i) a[i] = kernels::fma(s, c[i], b[i]);
}

// Least time of one call of `task` in seconds; all ranks begin together.
template <class Task>
double least_time(int calls, Task task) {
  double least = 1e30;
  for (int n = 0; n < calls; ++n) {
    (void)MPI_Barrier(PETSC_COMM_WORLD);
    const auto begin = std::chrono::steady_clock::now();
    task();
    least = std::min(least, std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
  }
  return least;
}

}  // namespace

double sum_over_ranks(double value) {
  (void)MPI_Allreduce(MPI_IN_PLACE, &value, 1, MPI_DOUBLE, MPI_SUM, PETSC_COMM_WORLD);
  return value;
}

Machine measure_machine() {
  const auto multiply_adds = [&](int lanes, void (*work)(double *)) {
    return 2.0 * lanes * rounds * threads() / least_time(100, [&] {
             in_parallel(threads(), threads(), [&](int) {
               double values[96];
               std::fill_n(values, 96, 0.5);
               work(values);
               benchmark::DoNotOptimize(values);
             });
           });
  };
  const std::ptrdiff_t n = 1 << 23;
  static std::vector<double> a(n), b(n, 1), c(n, 2);
  const double seconds = least_time(3, [&] {
    in_parallel(threads(), threads(), [&](int t) {
      const Piece piece(n, t, threads());
      const std::size_t at = piece.begin;
      triad(static_cast<std::ptrdiff_t>(piece.end - at), &a[at], &b[at], &c[at], 3);
    });
    benchmark::DoNotOptimize(a.data());
  });
  const double peak = std::max(multiply_adds(40, multiply_add_40), multiply_adds(96, multiply_add_96));
  return {sum_over_ranks(peak), sum_over_ranks(32.0 * n / seconds)};
}

}  // namespace eulastic::performance
