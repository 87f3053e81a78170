#include "io/deadline.hpp"

#include <unistd.h>
#include <csignal>

namespace eulastic {
namespace {

// Seconds: far more than any file system takes. In parts: a process that is stopped for an hour, by a batch system
// or a lid that is closed, finds one part gone when it goes on.
constexpr unsigned patience = 300, part = 5;
std::string line;
volatile std::sig_atomic_t parts = 0;

void end(int) {  // every rank has a deadline; MPI_Abort might wait in a signal handler
  if (--parts > 0) {
    (void)::alarm(part);
    return;
  }
  (void)!::write(STDERR_FILENO, line.data(), line.size());
  _exit(1);
}

}  // namespace

Deadline::Deadline(int rank, const std::string &path) {
  line.clear();
  if (rank == 0)
    line = "eulastic: error: " + path + ": not open after " + std::to_string(patience) +
           " s; a rank may have failed alone inside HDF5\n";
  struct sigaction action {};
  action.sa_handler = end;
  action.sa_flags = SA_RESTART;
  (void)sigaction(SIGALRM, &action, nullptr);
  parts = patience / part + (rank == 0 ? 0 : 6);  // it speaks
  (void)::alarm(part);
}

Deadline::~Deadline() { (void)::alarm(0); }

}  // namespace eulastic
