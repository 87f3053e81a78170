// eulastic: soft bodies in incompressible flow. Starts MPI and PETSc, parses the command line, acts on it
// (run/program.hpp) and ends.
#include "base/message_keeper.hpp"
#include "base/one_line.hpp"
#include "base/rank_zero.hpp"
#include "io/hdf5_handle.hpp"
#include "output/signals.hpp"
#include "run/program.hpp"
#include "run/run.hpp"

#include <cstdio>
#include <cstdlib>
#include <new>

using namespace eulastic;

namespace {

// Ends PETSc and MPI. Returns whether that failed, as when -log_view cannot write its file.
bool finalize() {
  int rank = 0;
  MPI_Comm_rank(PETSC_COMM_WORLD, &rank);
  const MessageKeeper kept;
  if (!PetscFinalize()) return MPI_Finalize() != MPI_SUCCESS;
  if (rank == 0) std::fprintf(stderr, "eulastic: error: at the end: %s\n", one_line(kept.text()).c_str());
  return true;
}

int program(int argc, char **argv) {
  int threads;
  if (MPI_Init_thread(nullptr, nullptr, MPI_THREAD_FUNNELED, &threads)) return exit_failed;
  const auto environment = on_rank_0([] {
    const char *given = std::getenv("PETSC_OPTIONS");
    return std::string(given ? given : "");
  });
  ParseResult parsed = parse({argv + 1, argv + argc}, environment);
  parsed.program = argv[0];
  unsetenv("PETSC_OPTIONS");
  const bool runs = !parsed.config.check_only && !parsed.config.print_options;  // no -log_view without a run
  std::vector<std::string> words = petsc_arguments(runs ? parsed.petsc : PetscOptionValues());
  std::vector<char *> petsc{argv[0]};
  for (std::string &word : words) petsc.push_back(word.data());
  petsc.push_back(nullptr);
  int petsc_count = static_cast<int>(petsc.size()) - 1;
  char **petsc_words = petsc.data();
  if (PetscInitialize(&petsc_count, &petsc_words, nullptr, nullptr)) return exit_failed;
  // Neighbours are found without an array over all ranks on every rank.
  (void)PetscCommBuildTwoSidedSetType(PETSC_COMM_WORLD, PETSC_BUILDTWOSIDED_IBARRIER);
  catch_faults();
  const int code = act(parsed);
  if (hdf5_file_left_open) MPI_Abort(PETSC_COMM_WORLD, code);
  return finalize() && code == exit_fine ? exit_failed : code;
}

// Handles unexpected exceptions, above all lack of memory. The other ranks must not wait for this one.
int give_up(const char *what) {
  int initialised = 0, rank = 0;
  MPI_Initialized(&initialised);
  if (initialised) MPI_Comm_rank(MPI_COMM_WORLD, &rank);
  std::fprintf(stderr, "eulastic: error: rank %d: %s\n", rank, what);
  std::fflush(stderr);
  if (initialised) MPI_Abort(MPI_COMM_WORLD, exit_failed);
  return exit_failed;
}

}  // namespace

int main(int argc, char **argv) {
  try {
    return program(argc, argv);
  } catch (const std::bad_alloc &) {
    return give_up("out of memory");
  } catch (const std::exception &error) {
    return give_up(error.what());
  }
}
