// eulastic: soft bodies in incompressible flow. Parses, then runs; every end of the program is in this file.
#include "app/check_only.hpp"
#include "app/overlap_warning.hpp"
#include "app/run.hpp"
#include "app/scene_warnings.hpp"
#include "app/signals.hpp"
#include "base/events.hpp"
#include "base/rank_zero.hpp"
#include "io/hdf5_file.hpp"

#include <unistd.h>
#include <cstdio>
#include <cstdlib>
#include <new>

using namespace eulastic;

namespace {

// Keeps PETSc's first message for our one line, not those of cleaning up after it, and prints no traceback.
PetscErrorCode keep_message(MPI_Comm, int, const char *, const char *, PetscErrorCode code, PetscErrorType type,
                            const char *message, void *text) {
  std::string &kept = *static_cast<std::string *>(text);
  if (type == PETSC_ERROR_INITIAL && message && kept.empty()) kept = message;
  return code;
}

void print_error(const std::string &message) {
  int rank = 0;
  MPI_Comm_rank(PETSC_COMM_WORLD, &rank);
  if (rank == 0) std::fprintf(stderr, "eulastic: error: %s\n", message.c_str());
}

// What -help, -check_only and -print_options print.
PetscErrorCode print_answer(const ParseResult &parsed, int ranks) {
  PetscFunctionBeginUser;
  std::string text = parsed.message, overlap;
  if (text.empty() && parsed.config.print_options) text = options_text(parsed);
  if (text.empty()) {
    text = check_report(parsed.config, ranks);
    PetscCall(find_overlap_warning(PETSC_COMM_WORLD, parsed.config, &overlap));
    if (!overlap.empty()) text += "warning: " + overlap + "\n";
    for (const std::string &warning : scene_warnings(parsed.config)) text += "warning: " + warning + "\n";
  }
  PetscCall(PetscPrintf(PETSC_COMM_WORLD, "%s", text.c_str()));
  PetscFunctionReturn(0);
}

int act(ParseResult &parsed) {
  int ranks = 1, code = exit_usage;
  MPI_Comm_size(PETSC_COMM_WORLD, &ranks);
  if (parsed.config.check_only && parsed.config.ranks > 0) ranks = parsed.config.ranks;
  if (parsed.error.empty() && parsed.config.check_only && parsed.config.balance && ranks > 1)
    parsed.error =
        "-balance: -check_only on more than one rank speaks of equal parts only, a run cuts by what its fields hold; "
        "accepted: -balance false with it";
  if (parsed.error.empty()) parsed.error = parsed.message.empty() ? Grid::why_not(parsed.config.grid, ranks) : "";
  if (!parsed.error.empty()) {
    print_error(parsed.error);
    return exit_usage;
  }
  if (!parsed.message.empty() || parsed.config.check_only || parsed.config.print_options) {
    return print_answer(parsed, ranks) ? exit_failed : parsed.alone ? exit_usage : exit_fine;
  }
  std::string kept, refusal;
  (void)PetscPushErrorHandler(keep_message, &kept);
  (void)register_events();
  const PetscErrorCode failed = run(parsed, &code, &refusal);
  (void)PetscPopErrorHandler();
  // Files (io/fail_together.hpp), linear systems and options are everybody's: all ranks know.
  if (failed == PETSC_ERR_FILE_UNEXPECTED || failed == PETSC_ERR_NOT_CONVERGED || failed == PETSC_ERR_USER_INPUT) {
    print_error(kept);
    return failed == PETSC_ERR_USER_INPUT ? exit_usage : exit_failed;
  }
  if (failed) {
    // A rank that fails alone must not leave the others waiting in a collective call.
    std::fprintf(stderr, "eulastic: error: %s\n", kept.empty() ? "internal error" : kept.c_str());
    std::fflush(stderr);
    MPI_Abort(PETSC_COMM_WORLD, exit_failed);
  }
  if (!refusal.empty()) print_error(refusal);
  return code;
}

// Whether it failed: -log_view and its like write here, to files that may not be there.
bool finalize() {
  int rank = 0;
  std::string kept;
  MPI_Comm_rank(PETSC_COMM_WORLD, &rank);
  (void)PetscPushErrorHandler(keep_message, &kept);
  if (!PetscFinalize()) return MPI_Finalize() != MPI_SUCCESS;
  if (rank == 0) std::fprintf(stderr, "eulastic: error: at the end: %s\n", kept.c_str());
  return true;
}

// Ranks and threads that wait give up their core, which others may need, unless the environment has it otherwise.
// OpenMP's run time looks at its environment before main: the program begins once more.
void wait_passively(char **argv) {
  setenv("OMPI_MCA_mpi_yield_when_idle", "1", 0);
  if (std::getenv("OMP_WAIT_POLICY") || std::getenv("GOMP_SPINCOUNT")) return;
  setenv("OMP_WAIT_POLICY", "passive", 1);
  char self[4096];
  const ssize_t length = readlink("/proc/self/exe", self, sizeof self - 1);
  if (length <= 0) return;
  self[length] = 0;
  (void)execv(self, argv);  // comes back only if it cannot
}

int program(int argc, char **argv) {
  wait_passively(argv);
  // Open MPI guards shared file pointers, which nobody uses here, with a semaphore named after the file. A process
  // killed while it holds it leaves it locked, and the next run that opens a file of that name waits for ever.
  setenv("OMPI_MCA_sharedfp", "^sm,lockedfile", 0);
  setenv("OMPI_MCA_ess_singleton_isolated", "1", 0);  // one rank by itself needs no daemon of Open MPI beside it
  const auto has = [](const char *name) { return std::getenv(name) != nullptr; };
  if (!has("OMPI_COMM_WORLD_RANK") && !has("PMIX_RANK") && !has("PMI_RANK"))
    setenv("OMPI_MCA_orte_create_session_dirs", "0", 0);  // nor a directory, which runs that end meanwhile may remove
  int threads;
  if (MPI_Init_thread(nullptr, nullptr, MPI_THREAD_FUNNELED, &threads)) return exit_failed;
  const auto environment = on_rank_0([] {
    const char *given = std::getenv("PETSC_OPTIONS");
    return std::string(given ? given : "");
  });
  ParseResult parsed = parse({argv + 1, argv + argc}, environment);
  parsed.program = argv[0];
  unsetenv("PETSC_OPTIONS");
  std::vector<char *> petsc{argv[0]};
  for (std::string &argument : parsed.petsc_arguments) {
    petsc.push_back(argument.data());
    if (parsed.config.check_only || parsed.config.print_options)
      break;  // after -skip_petscrc: no -log_view without a run
  }
  petsc.push_back(nullptr);
  int petsc_count = static_cast<int>(petsc.size()) - 1;
  char **petsc_arguments = petsc.data();
  if (PetscInitialize(&petsc_count, &petsc_arguments, nullptr, nullptr)) return exit_failed;
  // Who sends to whom is found without a number for every rank on every rank.
  (void)PetscCommBuildTwoSidedSetType(PETSC_COMM_WORLD, PETSC_BUILDTWOSIDED_IBARRIER);
  catch_faults();
  const int code = act(parsed);
  if (Hdf5File::left_open()) MPI_Abort(PETSC_COMM_WORLD, code);
  return finalize() && code == exit_fine ? exit_failed : code;
}

// What no verb expects, memory that is not there above all. The other ranks must not wait for this one.
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
