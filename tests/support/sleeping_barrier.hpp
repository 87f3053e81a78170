// A barrier whose waiting ranks sleep. Those of MPI spin, and take the cores from ranks that have work to do.
#pragma once

#include <mpi.h>
#include <unistd.h>

namespace eulastic::test {

/// Collective over `comm`. Returns MPI's error code.
inline int sleeping_barrier(MPI_Comm comm) {
  MPI_Request request;
  int done = 0, failed = MPI_Ibarrier(comm, &request);
  while (!failed && !done) {
    failed = MPI_Test(&request, &done, MPI_STATUS_IGNORE);
    if (!done) (void)usleep(300);
  }
  return failed;
}

}  // namespace eulastic::test
