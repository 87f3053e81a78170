// google-benchmark under PETSc; scripts/benchmark runs it and prints a table.
#include "machine.hpp"

#include "base/events.hpp"

#include <string>

int main(int argc, char **argv) {
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 1;
  int none = 1;
  char **arguments = argv;
  PetscCall(PetscInitialize(&none, &arguments, nullptr, nullptr));
  PetscCall(eulastic::register_events());
  benchmark::AddCustomContext("peak_gflops", std::to_string(1e-9 * eulastic::performance::peak_flops()));
  benchmark::AddCustomContext("triad_gbytes_per_second",
                              std::to_string(1e-9 * eulastic::performance::triad_bandwidth()));
  benchmark::RunSpecifiedBenchmarks();
  benchmark::Shutdown();
  PetscCall(PetscFinalize());
  return 0;
}
