#include "io/fail_together.hpp"

namespace eulastic {

PetscErrorCode fail_together(MPI_Comm comm, const std::string &problem) {
  int rank, ranks, first;
  PetscFunctionBeginUser;
  PetscCallMPI(MPI_Comm_rank(comm, &rank));
  PetscCallMPI(MPI_Comm_size(comm, &ranks));
  const int mine = problem.empty() ? ranks : rank;
  PetscCallMPI(MPI_Allreduce(&mine, &first, 1, MPI_INT, MPI_MIN, comm));
  if (first == ranks) PetscFunctionReturn(0);
  int length = static_cast<int>(problem.size());
  PetscCallMPI(MPI_Bcast(&length, 1, MPI_INT, first, comm));
  std::string text = problem;
  text.resize(length);
  PetscCallMPI(MPI_Bcast(text.data(), length, MPI_CHAR, first, comm));
  SETERRQ(comm, PETSC_ERR_FILE_UNEXPECTED, "%s", text.c_str());
}

}  // namespace eulastic
