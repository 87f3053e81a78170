// What does not depend on the number of ranks is computed on one: ranks beside it that computed it again would take the
// cores from each other.
#pragma once

#include "base/rank_zero.hpp"
#include "support/sleeping_barrier.hpp"

#include <gtest/gtest.h>

namespace eulastic::test {

/// Whether a test runs on one rank now, which tests of one rank need not do on each of several.
inline bool is_alone() {
  int ranks = 0;
  MPI_Comm_size(run_communicator(), &ranks);
  return ranks == 1;
}

/// Returns run(PETSC_COMM_SELF) of rank 0 on all ranks; the others sleep meanwhile. `share_result` shares a result that
/// is neither plain bytes nor a vector of such. Collective over run_communicator().
template <class Run, class Share>
auto on_one_rank(const Run &run, const Share &share_result) {
  int rank = 0;
  MPI_Comm_rank(run_communicator(), &rank);
  decltype(run(PETSC_COMM_SELF)) result{};
  if (rank == 0) {
    const RunOnRanks scope(PETSC_COMM_SELF);
    result = run(PETSC_COMM_SELF);
  }
  EXPECT_EQ(sleeping_barrier(run_communicator()), MPI_SUCCESS);
  share_result(&result);
  return result;
}

template <class Run>
auto on_one_rank(const Run &run) {
  return on_one_rank(run, [](auto *result) { share(result); });
}

}  // namespace eulastic::test
