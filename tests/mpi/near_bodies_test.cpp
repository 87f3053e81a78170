// find_surroundings: what every body hears of others and of surfaces, whoever owns them.
#include "adhesion/near_bodies.hpp"
#include "base/rank_zero.hpp"

#include <gtest/gtest.h>

#include <random>
#include <set>

namespace eulastic {
namespace {

struct Placed {
  BodyBlock body;
  int owner;
};

Extent grown(const Extent &extent, int by) {
  Extent more = extent;
  for (int d = 0; d < 3; ++d) {
    more.begin[d] -= by;
    more.end[d] += by;
  }
  return more;
}

// Cells of a block within the domain.
std::set<Int3> cells_of(const Domain &domain, const Extent &extent) {
  std::set<Int3> cells;
  for (int k = extent.begin[2]; k < extent.end[2]; ++k)
    for (int j = extent.begin[1]; j < extent.end[1]; ++j)
      for (int i = extent.begin[0]; i < extent.end[0]; ++i) {
        const Int3 cell{domain.image(0, i), domain.image(1, j), domain.image(2, k)};
        if (cell[1] >= 0 && cell[1] < domain.domain_cells()[1]) cells.insert(cell);
      }
  return cells;
}

bool share_cells(const std::set<Int3> &one, const std::set<Int3> &other) {
  for (const Int3 &cell : one)
    if (other.count(cell) > 0) return true;
  return false;
}

// 40 boxes in 17 x 12 x 14 cells with walls in y, two species of which only unlike ones adhere, one surface: cell by
// cell.
TEST(NearBodies, AllThatMeetAndNoOthers) {
  GridSpec spec;
  spec.cells = {17, 12, 14};
  spec.boundary = {Boundary::periodic, Boundary::wall, Boundary::periodic};
  Domain domain;
  ASSERT_EQ(domain.create(run_communicator(), spec), 0);
  std::mt19937 random(7);
  std::vector<Placed> all;
  for (int number = 1; number <= 40; ++number) {
    Extent box{};
    for (int d = 0; d < 3; ++d) {
      const int length = 2 + static_cast<int>(random() % 3), room = d == 1 ? 12 - length : 34;
      box.begin[d] = static_cast<int>(random() % room) - (d == 1 ? 0 : 17);
      box.end[d] = box.begin[d] + length;
    }
    all.push_back({{number, number % 2, box, grown(box, 1)}, static_cast<int>(random() % domain.ranks())});
  }
  const Int3 surface{8, 5, 6};
  const auto has_surface = [&](int species, const Extent &hull) {
    return species == 0 && domain.owner(8, 5, 6) == domain.rank() && cells_of(domain, hull).count(surface) > 0;
  };
  std::vector<BodyBlock> own;
  for (const Placed &placed : all)
    if (placed.owner == domain.rank()) own.push_back(placed.body);
  std::map<int, Surroundings> found;
  ASSERT_EQ(find_surroundings(
                domain, own, [](int one, int other) { return one != other; }, has_surface, &found),
            0);
  int pairs = 0;
  for (const BodyBlock &body : own) {
    const Surroundings around = found[body.number];
    EXPECT_EQ(around.surface, body.species == 0 && cells_of(domain, body.hull).count(surface) > 0);
    std::set<int> numbers, wanted;
    for (const NearBody &near : around.bodies) {
      EXPECT_TRUE(numbers.insert(near.number).second) << "twice";
      EXPECT_EQ(near.rank, all[near.number - 1].owner);
      EXPECT_EQ(near.box.begin, all[near.number - 1].body.box.begin);
    }
    const std::set<Int3> box = cells_of(domain, body.box), hull = cells_of(domain, body.hull);
    for (const Placed &other : all)
      if (other.body.species != body.species &&
          (share_cells(hull, cells_of(domain, other.body.box)) || share_cells(box, cells_of(domain, other.body.hull))))
        wanted.insert(other.body.number);
    EXPECT_EQ(numbers, wanted) << body.number;
    pairs += static_cast<int>(wanted.size());
  }
  MPI_Allreduce(MPI_IN_PLACE, &pairs, 1, MPI_INT, MPI_SUM, run_communicator());
  EXPECT_GT(pairs, 40);
  EXPECT_LT(pairs, 39 * 20);
}

}  // namespace
}  // namespace eulastic
