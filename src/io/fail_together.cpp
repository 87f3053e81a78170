#include "io/fail_together.hpp"

#include "base/one_line.hpp"

#include <unistd.h>
#include <cstdio>

namespace eulastic {
namespace {

constexpr double patience = 10;  // seconds

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

}  // namespace eulastic
