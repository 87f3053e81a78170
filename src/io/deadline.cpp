#include "io/deadline.hpp"

#include <unistd.h>
#include <csignal>

namespace eulastic {
namespace {

constexpr unsigned patience = 300;  // seconds: far more than any file system needs
std::string line;

void end(int) {  // every rank has a deadline; MPI_Abort might wait in a signal handler
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
  (void)::alarm(patience + (rank == 0 ? 0 : 5));  // it speaks
}

Deadline::~Deadline() { (void)::alarm(0); }

}  // namespace eulastic
