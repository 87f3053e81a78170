// GoogleTest with PETSc and MPI. Under mpiexec -n N every chosen test runs on N, N - 1, ... 1 ranks, each time on a
// communicator of its own (run_communicator()); ranks that are left over run it on their own number beside it.
// EULASTIC_QUICK=1: of four ranks only 3 and 1.
#include "base/events.hpp"
#include "base/rank_zero.hpp"
#include "support/leaks.hpp"
#include "support/sleeping_barrier.hpp"

#include <gtest/gtest.h>

#include <cstdlib>
#include <cstring>

namespace {

int ranks_now = 1;

// Prints failures, and on how many ranks they happened.
class FailurePrinter : public ::testing::EmptyTestEventListener {
  void OnTestPartResult(const ::testing::TestPartResult &result) override {
    if (!result.failed()) return;
    int rank = 0;
    MPI_Comm_rank(eulastic::run_communicator(), &rank);
    std::fprintf(stderr, "%s:%d: on rank %d of %d: %s\n", result.file_name(), result.line_number(), rank, ranks_now,
                 result.summary());
  }
};

// Runs the chosen tests on this rank's part of the world, parts of `ranks` ranks and one of the rest; returns whether
// any failed.
int run_on(int ranks, int world_rank, int world_size) {
  const bool rest = world_rank >= ranks;
  // The rest is run where it is a number of its own: 3 and 1 of 4, but not 2 and 2.
  const bool wanted = !rest || world_size - ranks < ranks;
  MPI_Comm part;
  MPI_Comm_split(MPI_COMM_WORLD, wanted ? rest : MPI_UNDEFINED, world_rank, &part);
  if (!wanted) return 0;
  int failed = 0;
  {
    const eulastic::RunOnRanks scope(part);
    MPI_Comm_size(part, &ranks_now);
    failed = RUN_ALL_TESTS();
  }
  MPI_Comm_free(&part);
  return failed;
}

}  // namespace

int main(int argc, char **argv) {
  ::testing::InitGoogleTest(&argc, argv);
  if (::testing::GTEST_FLAG(list_tests)) {  // without MPI, and once
    const char *rank = std::getenv("OMPI_COMM_WORLD_RANK");
    return rank && std::strcmp(rank, "0") != 0 ? 0 : RUN_ALL_TESTS();
  }
  PetscCall(PetscInitialize(&argc, &argv, nullptr, nullptr));
  PetscCall(eulastic::register_events());
  int rank = 0, size = 1;
  MPI_Comm_rank(MPI_COMM_WORLD, &rank);
  MPI_Comm_size(MPI_COMM_WORLD, &size);
  auto &listeners = ::testing::UnitTest::GetInstance()->listeners();
  if (size > 1) {
    if (rank != 0) delete listeners.Release(listeners.default_result_printer());
    listeners.Append(new FailurePrinter);
  }
  int failed = 0;
  const bool quick = std::getenv("EULASTIC_QUICK") != nullptr;  // on 3 and 1 ranks of 4 only
  for (int ranks = size; 2 * ranks >= size; --ranks) {
    if (quick && size == 4 && ranks != 3) continue;
    failed |= run_on(ranks, rank, size);
    (void)eulastic::test::sleeping_barrier(MPI_COMM_WORLD);
  }
  MPI_Allreduce(MPI_IN_PLACE, &failed, 1, MPI_INT, MPI_MAX, MPI_COMM_WORLD);
  eulastic::test::check_leaks();
  PetscCall(PetscFinalize());
  return failed;
}
