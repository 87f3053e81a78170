// google-benchmark under PETSc; scripts/benchmark runs it and prints a table. Under mpiexec rank 0 reports. --threads=N
// comes first.
#include "base/events.hpp"
#include "box.hpp"
#include "grid/threads.hpp"

#include <algorithm>
#include <cstdlib>
#include <string>
#include <vector>

namespace {

struct Silent : benchmark::BenchmarkReporter {
  bool ReportContext(const Context &) override { return true; }
  void ReportRuns(const std::vector<Run> &) override {}
};

}  // namespace

int main(int argc, char **argv) {
  int none = 1;
  char **arguments = argv;
  PetscCall(PetscInitialize(&none, &arguments, nullptr, nullptr));
  int rank = 0, ranks = 1;
  PetscCallMPI(MPI_Comm_rank(PETSC_COMM_WORLD, &rank));
  PetscCallMPI(MPI_Comm_size(PETSC_COMM_WORLD, &ranks));
  std::vector<char *> words;
  const std::string first = argc > 1 ? argv[1] : "", option = "--threads=";
  const bool threaded = first.rfind(option, 0) == 0;
  if (threaded) eulastic::set_threads(std::max(1, std::atoi(first.c_str() + option.size())));
  for (int i = 0; i < argc; i += i == 0 && threaded ? 2 : 1)
    if (rank == 0 || std::string(argv[i]).rfind("--benchmark_out", 0) != 0) words.push_back(argv[i]);
  words.push_back(nullptr);
  int count = static_cast<int>(words.size()) - 1;
  benchmark::Initialize(&count, words.data());
  if (benchmark::ReportUnrecognizedArguments(count, words.data())) return 1;
  PetscCall(eulastic::register_events());
  benchmark::AddCustomContext("ranks", std::to_string(ranks));
  Silent silent;
  if (rank == 0)
    benchmark::RunSpecifiedBenchmarks();
  else
    benchmark::RunSpecifiedBenchmarks(&silent);
  benchmark::Shutdown();
  eulastic::performance::forget_box();
  PetscCall(PetscFinalize());
  return 0;
}
