// Distributions of coarse levels: fewer cells, fewer ranks, or all cells on every rank.
#include "pressure/partition.hpp"

#include <gtest/gtest.h>

namespace eulastic {
namespace {

Partition planned(const Int3 &cells, const Int3 &ranks) {
  GridSpec spec;
  spec.cells = cells;
  spec.processors = ranks;
  return Partition(Domain::planned(spec, ranks[0] * ranks[1] * ranks[2]));
}

// Every second rank keeps cells, with those of two ranks, the last one with those of three.
TEST(Partition, JoinsRanks) {
  const Partition once = planned({8, 16, 8}, {1, 5, 2}).joined({false, true, false});
  const Partition twice = once.joined({false, true, true});
  EXPECT_EQ(once.split().starts[1], (std::vector<int>{0, 6, 6, 16, 16, 16}));
  EXPECT_EQ(once.split().starts[2], (std::vector<int>{0, 4, 8}));
  EXPECT_EQ(twice.split().starts[1], (std::vector<int>{0, 16, 16, 16, 16, 16}));
  EXPECT_EQ(twice.split().starts[2], (std::vector<int>{0, 8, 8}));
  const auto owner = [](const Split &split, const Int3 &cell) {
    return split.rank_at(
        {split.position_along(0, cell[0]), split.position_along(1, cell[1]), split.position_along(2, cell[2])});
  };
  EXPECT_EQ(owner(once.split(), {0, 5, 4}), 5);
  EXPECT_EQ(owner(once.split(), {0, 6, 0}), 2);
  EXPECT_EQ(owner(twice.split(), {7, 15, 7}), 0);
  EXPECT_EQ(twice.box().cells(), (Int3{8, 16, 8}));
  EXPECT_EQ(twice.ranks(), 10);
}

// In directions that are halved, the first cell of each rank is half of its former one, rounded up.
TEST(Partition, HasRanksWithoutCellsOnCoarseLevels) {
  const Partition fine = planned({8, 10, 6}, {1, 3, 2}), coarse = fine.coarse({8, 5, 3}),
                  last = coarse.coarse({8, 2, 1});
  EXPECT_EQ(fine.split().starts[1], (std::vector<int>{0, 3, 6, 10}));
  EXPECT_EQ(coarse.split().starts[0], (std::vector<int>{0, 8}));
  EXPECT_EQ(coarse.split().starts[1], (std::vector<int>{0, 2, 3, 5}));
  EXPECT_EQ(coarse.split().starts[2], (std::vector<int>{0, 2, 3}));
  EXPECT_EQ(coarse.box().cells(), (Int3{8, 2, 2}));
  EXPECT_EQ(coarse.box().domain_cells(), (Int3{8, 5, 3}));
  EXPECT_EQ(last.split().starts[1], (std::vector<int>{0, 1, 2, 2}));
  EXPECT_EQ(last.split().starts[2], (std::vector<int>{0, 1, 1}));
}

TEST(Partition, CanHaveAllCellsOnEveryRank) {
  const Partition all = planned({8, 10, 6}, {1, 3, 2}).everywhere();
  EXPECT_EQ(all.ranks(), 1);
  EXPECT_EQ(all.box().cells(), (Int3{8, 10, 6}));
  EXPECT_EQ(all.split().starts[1], (std::vector<int>{0, 10}));
}

}  // namespace
}  // namespace eulastic
