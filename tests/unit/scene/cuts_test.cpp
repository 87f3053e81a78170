// Cuts by cost: whole units, the fewest cells of a rank, and the least largest sum that there is.
#include "grid/domain.hpp"
#include "scene/balance.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <random>

namespace eulastic {
namespace {

double largest(const std::vector<double> &cost, const std::vector<int> &first) {
  double most = 0;
  for (std::size_t p = 0; p + 1 < first.size(); ++p)
    most = std::max(most, std::accumulate(cost.begin() + first[p], cost.begin() + first[p + 1], 0.0));
  return most;
}

// Of all ways to give each of `parts` ranks a unit or more of those from `begin` on.
double least_largest(const std::vector<double> &cost, int begin, int parts) {
  const int units = static_cast<int>(cost.size());
  if (parts == 1) return largest(cost, {begin, units});
  double best = HUGE_VAL, sum = 0;
  for (int end = begin + 1; units - end >= parts - 1; ++end) {
    sum += cost[end - 1];
    best = std::min(best, std::max(sum, least_largest(cost, end, parts - 1)));
  }
  return best;
}

std::vector<double> random_costs(std::mt19937 &random, int units) {
  std::vector<double> cost(units);
  for (double &c : cost) c = std::max(0, int(random() % 12) - 3);
  return cost;
}

TEST(Cuts, UnitsLeaveAnEighth) {
  EXPECT_EQ(cut_unit(64, 4), 2);
  EXPECT_EQ(cut_unit(64, 1), 8);
  EXPECT_EQ(cut_unit(63, 2), 1);
  EXPECT_EQ(cut_unit(5120, 32), 16);
}

TEST(Cuts, OfEqualCostsAreEven) {
  for (int parts = 1; parts <= 5; ++parts) {
    const std::vector<int> first = equal_cuts(std::vector<double>(21, 3), parts, 1);
    for (int p = 0; p < parts; ++p) {
      EXPECT_GE(first[p + 1] - first[p], 21 / parts);
      EXPECT_LE(first[p + 1] - first[p], (20 + parts) / parts);
    }
  }
}

TEST(Cuts, TheLargestSumIsTheLeast) {
  std::mt19937 random(1);
  for (int units = 3; units <= 12; ++units)
    for (int parts = 1; parts <= std::min(units, 5); ++parts)
      for (int trial = 0; trial < 20; ++trial) {
        const std::vector<double> cost = random_costs(random, units);
        EXPECT_NEAR(largest(cost, equal_cuts(cost, parts, 0)), least_largest(cost, 0, parts), 1e-9);
      }
}

TEST(Cuts, LeaveEveryRankItsCells) {
  std::mt19937 random(2);
  for (int least = 1; least <= 3; ++least)
    for (int parts = 1; parts <= 6; ++parts)
      for (int trial = 0; trial < 30; ++trial) {
        const int units = parts * least + int(random() % 9);
        const std::vector<int> first = equal_cuts(random_costs(random, units), parts, least);
        ASSERT_EQ(first.size(), std::size_t(parts) + 1);
        EXPECT_EQ(first[0], 0);
        EXPECT_EQ(first[parts], units);
        for (int p = 0; p < parts; ++p) EXPECT_GE(first[p + 1] - first[p], least);
      }
  EXPECT_EQ(equal_cuts({0, 0, 0, 0, 0, 0}, 2, 3), (std::vector<int>{0, 3, 6}));
}

TEST(Cuts, AreTheGridsWhereTheyAreGiven) {
  GridSpec spec;
  spec.cells = {8, 16, 12};
  spec.starts = {std::vector<int>{0, 8}, {0, 3, 16}, {0, 9, 12}};
  EXPECT_EQ(Domain::decompose(spec, 4), (Int3{1, 2, 2}));
  EXPECT_EQ(Domain::largest_box(spec, {1, 2, 2}), (Int3{8, 13, 9}));
  const Domain domain = Domain::planned(spec, 4);
  const Layout last = domain.split().box_of(3, spec, 0).layout();
  EXPECT_EQ(last.begin, (Int3{0, 3, 9}));
  EXPECT_EQ(last.cells, (Int3{8, 13, 3}));
  EXPECT_NE(Domain::refusal_reason(spec, 2), "");
  spec.starts[2] = {0, 10, 12};  // two cells
  EXPECT_NE(Domain::refusal_reason(spec, 4), "");
}

}  // namespace
}  // namespace eulastic
