#include "output/signals.hpp"

#include <petscsys.h>
#include <unistd.h>
#include <csignal>
#include <cstdio>
#include <cstring>

namespace eulastic {
namespace {

volatile std::sig_atomic_t caught = 0;
bool speaks = false;
int own_rank = 0;

// write(2) alone, as a signal may come inside malloc or printf.
void say(const char *text) { (void)!::write(STDERR_FILENO, text, std::strlen(text)); }

// The current step may be long, and a launcher may kill the process before it ends: prints a line at once.
void remember(int signal) {
  if (speaks && !caught) {
    char line[100] = "eulastic: SIG";
    const char *name = sigabbrev_np(signal);
    std::strncat(line, name ? name : "NAL", 20);
    std::strncat(line, ": ends after this step, with a checkpoint\n", 60);
    say(line);
  }
  caught = 1;
}

bool is_ignored(int signal) {
  struct sigaction action {};
  return sigaction(signal, nullptr, &action) == 0 && action.sa_handler == SIG_IGN;
}

void handle(int signal, void (*handler)(int), int flags) {
  struct sigaction action {};
  action.sa_handler = handler;
  action.sa_flags = flags;
  (void)sigaction(signal, &action, nullptr);
}

void end_now(int) { _exit(1); }

// Other ranks must not wait for a dead one. MPI_Abort ends them, but it takes locks that this process may hold: after
// five seconds the process exits without it, which the launcher detects.
void end_all(int signal) {
  char text[160];
  (void)std::snprintf(text, sizeof text,
                      "eulastic: error: rank %d received signal %d (%s): a fault of the program or the machine\n",
                      own_rank, signal, signal == SIGSEGV ? "invalid memory" : sigabbrev_np(signal));
  say(text);
  handle(SIGALRM, end_now, 0);
  sigset_t alarms;
  (void)sigemptyset(&alarms);
  (void)sigaddset(&alarms, SIGALRM);
  (void)pthread_sigmask(SIG_UNBLOCK, &alarms, nullptr);
  (void)::alarm(5);
  MPI_Abort(PETSC_COMM_WORLD, 1);
  _exit(1);
}

}  // namespace

void catch_faults() {
  PetscBool unwanted = PETSC_FALSE;
  (void)PetscOptionsHasName(nullptr, nullptr, "-no_signal_handler", &unwanted);
  if (unwanted) return;
  MPI_Comm_rank(PETSC_COMM_WORLD, &own_rank);
  static char stack[1 << 18];  // the handler's, as a fault may be that the program's own stack has come to its end
  const stack_t alternative{stack, 0, sizeof stack};
  (void)sigaltstack(&alternative, nullptr);
  const int once = static_cast<int>(SA_RESETHAND) | SA_ONSTACK;  // a second fault kills at once
  for (const int signal : {SIGHUP, SIGPIPE, SIGQUIT, SIGTERM, SIGURG})
    if (!is_ignored(signal)) handle(signal, SIG_DFL, 0);  // PETSc's handlers, which print a page
  for (const int signal : {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT, SIGSYS, SIGTRAP}) handle(signal, end_all, once);
}

void catch_signals() {
  MPI_Comm_rank(PETSC_COMM_WORLD, &own_rank);
  speaks = own_rank == 0;
  for (const int signal : {SIGTERM, SIGUSR1, SIGUSR2, SIGHUP, SIGPIPE, SIGXCPU})
    if (!is_ignored(signal)) handle(signal, remember, SA_RESTART);  // ignored: as nohup asks for SIGHUP
  handle(SIGINT, remember, SA_RESTART | static_cast<int>(SA_RESETHAND));
  (void)std::signal(SIGXFSZ, SIG_IGN);  // a file that may not grow is an error we report
}

bool signal_caught() { return caught != 0; }

}  // namespace eulastic
