// share_out(): all ranks get about as much to do, whoever had the bodies before.
#include "boxes/share_out.hpp"
#include "base/rank_zero.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

namespace eulastic {
namespace {

TEST(ShareOut, WaterRisesFromTheLowestBowl) {
  EXPECT_DOUBLE_EQ(water_level({3}, 2), 5);
  EXPECT_DOUBLE_EQ(water_level({1, 5, 2}, 0), 1);
  EXPECT_DOUBLE_EQ(water_level({1, 5, 2}, 0.5), 1.5);
  EXPECT_DOUBLE_EQ(water_level({1, 5, 2}, 3), 3);
  EXPECT_DOUBLE_EQ(water_level({1, 5, 2}, 7), 5);
  EXPECT_DOUBLE_EQ(water_level({1, 5, 2}, 10), 6);
}

// Of all bodies, on every rank.
std::vector<int> shared(MPI_Comm comm, int first_owner, double load, int count) {
  int rank, ranks;
  MPI_Comm_rank(comm, &rank);
  MPI_Comm_size(comm, &ranks);
  std::vector<BodyShare> mine;
  for (int b = count - 1; b >= 0; --b)
    if ((b + first_owner) % ranks == rank)
      mine.push_back({b + 1, b * b % ranks * (b % 3) % ranks, 1. + b % 7});  // few homes, many bodies in some
  std::vector<int> targets, all(count, -1);
  EXPECT_EQ(share_out(comm, load, mine, &targets), 0);
  EXPECT_EQ(targets.size(), mine.size());
  for (std::size_t n = 0; n < mine.size(); ++n) all[mine[n].number - 1] = targets[n];
  MPI_Allreduce(MPI_IN_PLACE, all.data(), count, MPI_INT, MPI_MAX, comm);
  return all;
}

TEST(ShareOut, IsEvenWhateverRanksHaveBesides) {
  const MPI_Comm comm = run_communicator();
  constexpr int count = 61;
  int rank, ranks;
  MPI_Comm_rank(comm, &rank);
  MPI_Comm_size(comm, &ranks);
  for (const double slope : {0., 10., 1000.}) {
    std::vector<double> loads(ranks);
    for (int r = 0; r < ranks; ++r) loads[r] = slope * (ranks - r);
    const std::vector<int> targets = shared(comm, 0, loads[rank], count);
    double total = 0;
    std::vector<double> work = loads;
    for (int b = 0; b < count; ++b) {
      ASSERT_GE(targets[b], 0);
      ASSERT_LT(targets[b], ranks);
      work[targets[b]] += 1 + b % 7;
      total += 1 + b % 7;
    }
    // At most the part of a body that lies across the border to the next rank.
    const double level = water_level(loads, total);
    for (int r = 0; r < ranks; ++r) EXPECT_LE(work[r], std::max(level, loads[r]) + 7) << "slope " << slope;
    for (int owner = 1; owner < ranks; ++owner) EXPECT_EQ(shared(comm, owner, loads[rank], count), targets) << owner;
  }
}

}  // namespace
}  // namespace eulastic
