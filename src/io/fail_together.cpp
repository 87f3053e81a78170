#include "io/fail_together.hpp"

#include "base/one_line.hpp"

#include <unistd.h>
#include <csignal>
#include <cstdio>

namespace eulastic {
namespace {

constexpr double patience = 10;  // seconds that a rank that has failed waits for the others

// Seconds of a Deadline: far more than any file system takes. In parts: a process that is stopped for an hour, by a
// batch system or a lid that is closed, finds one part gone when it goes on.
constexpr unsigned longest_call = 300, part = 5;
std::string line;
volatile std::sig_atomic_t parts = 0;

// Ends the job if the other ranks do not arrive: they wait inside HDF5 or MPI-IO for the rank that has failed alone.
PetscErrorCode wait_for_others(MPI_Comm comm, MPI_Request *request, int rank, const std::string &problem) {
  int there = 0;
  PetscFunctionBeginUser;
  for (const double begin = MPI_Wtime(); !there && MPI_Wtime() < begin + patience; (void)::usleep(1000))
    PetscCallMPI(MPI_Test(request, &there, MPI_STATUS_IGNORE));
  if (!there) {
    std::fprintf(stderr, "eulastic: error: rank %d alone: %s\n", rank, one_line(problem).c_str());
    std::fflush(stderr);
    MPI_Abort(comm, 1);
  }
  PetscFunctionReturn(0);
}

void end(int) {  // every rank has a deadline; MPI_Abort might wait in a signal handler
  if (--parts > 0) {
    (void)::alarm(part);
    return;
  }
  (void)!::write(STDERR_FILENO, line.data(), line.size());
  _exit(1);
}

}  // namespace

PetscErrorCode fail_together(MPI_Comm comm, const std::string &problem) {
  int rank, ranks, first;
  PetscFunctionBeginUser;
  PetscCallMPI(MPI_Comm_rank(comm, &rank));
  PetscCallMPI(MPI_Comm_size(comm, &ranks));
  const int mine = problem.empty() ? ranks : rank;
  MPI_Request request;
  PetscCallMPI(MPI_Iallreduce(&mine, &first, 1, MPI_INT, MPI_MIN, comm, &request));
  if (!problem.empty()) PetscCall(wait_for_others(comm, &request, rank, problem));
  PetscCallMPI(MPI_Wait(&request, MPI_STATUS_IGNORE));
  if (first == ranks) PetscFunctionReturn(0);
  int length = static_cast<int>(problem.size());
  PetscCallMPI(MPI_Bcast(&length, 1, MPI_INT, first, comm));
  std::string text = problem;
  text.resize(length);
  PetscCallMPI(MPI_Bcast(text.data(), length, MPI_CHAR, first, comm));
  SETERRQ(comm, PETSC_ERR_FILE_UNEXPECTED, "%s", text.c_str());
}

Deadline::Deadline(int rank, const std::string &path) {
  line.clear();
  if (rank == 0)
    line = "eulastic: error: " + path + ": not open after " + std::to_string(longest_call) +
           " s; one rank may have failed while the others wait for it inside HDF5\n";
  struct sigaction action {};
  action.sa_handler = end;
  action.sa_flags = SA_RESTART;
  (void)sigaction(SIGALRM, &action, nullptr);
  parts = longest_call / part + (rank == 0 ? 0 : 6);  // it speaks
  (void)::alarm(part);
}

Deadline::~Deadline() { (void)::alarm(0); }

}  // namespace eulastic
