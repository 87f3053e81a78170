#include "app/signals.hpp"

#include <petscsys.h>
#include <unistd.h>
#include <csignal>
#include <cstdio>
#include <string_view>

namespace eulastic {
namespace {

volatile std::sig_atomic_t caught = 0;
bool speaks = false;

// The step under way may be long, and a launcher may kill before it ends: a word at once.
void remember(int signal) {
  static constexpr std::string_view term = "eulastic: SIGTERM: ends after this step, with a checkpoint\n",
                                    interrupt = "eulastic: SIGINT: ends after this step, with a checkpoint\n",
                                    user = "eulastic: SIGUSR1: ends after this step, with a checkpoint\n";
  if (speaks && !caught) {
    const std::string_view line = signal == SIGTERM ? term : signal == SIGINT ? interrupt : user;
    (void)!::write(STDERR_FILENO, line.data(), line.size());
  }
  caught = 1;
}

void handle(int signal, int flags) {
  struct sigaction action {};
  action.sa_handler = remember;
  action.sa_flags = SA_RESTART | flags;
  (void)sigaction(signal, &action, nullptr);
}

// Others must not wait for a rank that is gone.
PetscErrorCode end_all(int signal, void *) {
  int rank = 0;
  MPI_Comm_rank(PETSC_COMM_WORLD, &rank);
  char text[160];
  const int length = std::snprintf(
      text, sizeof text, "eulastic: error: rank %d met signal %d (%s): a defect of the program or the machine\n", rank,
      signal, signal == SIGSEGV ? "invalid memory" : sigabbrev_np(signal));
  (void)!::write(STDERR_FILENO, text, static_cast<std::size_t>(length));
  MPI_Abort(PETSC_COMM_WORLD, 1);
  return 0;
}

}  // namespace

void catch_faults() {
  PetscBool unwanted = PETSC_FALSE;
  (void)PetscOptionsHasName(nullptr, nullptr, "-no_signal_handler", &unwanted);
  if (!unwanted) (void)PetscPushSignalHandler(end_all, nullptr);
}

void catch_signals() {
  int rank = 0;
  MPI_Comm_rank(PETSC_COMM_WORLD, &rank);
  speaks = rank == 0;
  handle(SIGUSR1, 0);
  handle(SIGTERM, 0);
  handle(SIGINT, static_cast<int>(SA_RESETHAND));
  (void)std::signal(SIGXFSZ, SIG_IGN);  // a file that may not grow is an error we report
}

bool signal_caught() { return caught != 0; }

}  // namespace eulastic
