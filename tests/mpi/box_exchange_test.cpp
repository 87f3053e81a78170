// BoxExchange: boxes anywhere, across periodic sides and cut at walls, owned by any rank.
#include "boxes/box_exchange.hpp"
#include "base/rank_zero.hpp"
#include "support/all_segments.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <tuple>

namespace eulastic {
namespace {

constexpr double nothing = std::numeric_limits<double>::quiet_NaN();

struct Block {
  Int3 begin, cells;
};
// In 13 x 10 x 11 cells with walls in y: inside, across each periodic side and all edges of x and z, at both walls,
// longer than the domain, so that it meets itself, as long as the domain, and two at the same place.
const std::vector<Block> blocks{{{3, 2, 4}, {4, 5, 3}},     {{-2, 0, 3}, {6, 4, 6}},   {{11, 6, 9}, {5, 4, 5}},
                                {{-13, 3, -3}, {19, 3, 5}}, {{4, 0, -5}, {3, 10, 11}}, {{4, 0, -5}, {3, 10, 11}}};

// On every rank count with x whole, and with x split.
class BoxExchangeTest : public ::testing::TestWithParam<bool> {
protected:
  void SetUp() override {
    GridSpec spec;
    spec.cells = {13, 10, 11};
    spec.boundary = {Boundary::periodic, Boundary::wall, Boundary::periodic};
    if (GetParam()) MPI_Comm_size(run_communicator(), &spec.processors[0]);
    ASSERT_EQ(domain.create(run_communicator(), spec), 0);
    for (const Block &block : blocks) boxes.emplace_back(domain.domain_shape(), block.begin, block.cells, 3);
  }
  // Visits the points of a box without ghosts, with their indices in the domain.
  template <class Visit>
  static void for_each_point(const Box &box, const Visit &visit) {
    const Int3 &begin = box.layout().begin;
    for (int k = 0; k < box.points_end(2, true); ++k)
      for (int j = 0; j < box.points_end(1, true); ++j)
        for (int i = 0; i < box.points_end(0, true); ++i)
          visit(Int3{i, j, k},
                Int3{box.image(0, begin[0] + i), box.image(1, begin[1] + j), box.image(2, begin[2] + k)});
  }
  // The boxes that this rank owns: dealt out in turn from a rank on, or all on it.
  std::vector<std::size_t> owned(int first, bool deal) const {
    std::vector<std::size_t> mine;
    for (std::size_t b = 0; b < boxes.size(); ++b)
      if ((first + (deal ? static_cast<int>(b) : 0)) % domain.ranks() == domain.rank()) mine.push_back(b);
    return mine;
  }
  std::vector<BoxExchange::NumberedBox> numbered(const std::vector<std::size_t> &mine) const {
    std::vector<BoxExchange::NumberedBox> list;
    for (const std::size_t b : mine) list.push_back({&boxes[b], static_cast<int>(10 + 7 * b)});
    return list;
  }

  Domain domain;
  std::vector<Box> boxes;
};

double value_at(int f, const Int3 &at) { return 1 + at[0] + 64 * at[1] + 4096.0 * at[2] + 262144.0 * f; }

TEST_P(BoxExchangeTest, BringsEveryPointAndNoMore) {
  Field grid(domain, 3);
  for (int f = 0; f < 3; ++f) {
    grid.fill(f, nothing);
    for_each_point(domain, [&](const Int3 &p, const Int3 &at) { grid[f](p[0], p[1], p[2]) = value_at(f, at); });
  }
  BoxExchange exchange(domain, 3);
  for (const bool deal : {true, false, true}) {
    const std::vector<std::size_t> mine = owned(deal ? 1 : 0, deal);
    ASSERT_EQ(exchange.connect(numbered(mine)), 0);
    ASSERT_EQ(exchange.fetch(grid), 0);
    for (std::size_t n = 0; n < mine.size(); ++n) {
      const Box &box = boxes[mine[n]];
      Field got(box, 3);
      for (int f = 0; f < 3; ++f) got.fill(f, nothing);
      exchange.copy_to_box(n, grid, got);
      std::ptrdiff_t wrong = 0, points = 0, written = 0;
      for (int f = 0; f < 3; ++f)
        for_each_point(box, [&](const Int3 &p, const Int3 &at) {
          ++points;
          wrong += got[f](p[0], p[1], p[2]) != value_at(f, at);
        });
      for (std::ptrdiff_t v = 0; v < 3 * box.layout().size; ++v) written += !std::isnan(got.data()[v]);
      EXPECT_EQ(wrong, 0) << "box " << mine[n];
      EXPECT_EQ(written, points) << "box " << mine[n];
    }
  }
}

// What box b gives to a component at a point of it.
double share(std::size_t b, int f, const Int3 &p) {
  static constexpr std::array<double, 6> sizes{1e16, 1, -1e16, 3, -1e16, 1e16};
  return (p[0] + p[1] + f) % 3 == 0 ? 0 : sizes[b] * (1 + p[2] + 0.1 * p[0]);
}

// Of 1e16, 1 and -1e16 every order has another sum; what a box does not add leaves -0 as it is.
TEST_P(BoxExchangeTest, AddsInTheOrderOfNumbersWhoeverOwnsTheBoxes) {
  Field expected(domain, 3);
  for (int f = 0; f < 3; ++f) expected.fill(f, -0.0);
  for (std::size_t b = 0; b < boxes.size(); ++b)
    for (int f = 0; f < 3; ++f)
      for_each_point(boxes[b], [&](const Int3 &own, const Int3 &at) {
        const Int3 &begin = domain.layout().begin;
        const Int3 p{at[0] - begin[0], at[1] - begin[1], at[2] - begin[2]};
        for (int d = 0; d < 3; ++d)
          if (p[d] < 0 || p[d] >= domain.points_end(d, true)) return;
        const double value = share(b, f, own);
        if (value != 0) expected[f](p[0], p[1], p[2]) += value;
      });
  BoxExchange exchange(domain, 3);
  for (const bool deal : {true, false})
    for (int first = 0; first < domain.ranks(); ++first) {
      const std::vector<std::size_t> mine = owned(first, deal);
      ASSERT_EQ(exchange.connect(numbered(mine)), 0);
      std::vector<SegmentValues> values(mine.size());
      std::vector<ActiveSegments> segments(mine.size());
      for (std::size_t n = 0; n < mine.size(); ++n) {
        const Box &box = boxes[mine[n]];
        Field field(box, 3);
        for (int f = 0; f < 3; ++f)
          for_each_point(box, [&](const Int3 &p, const Int3 &) { field[f](p[0], p[1], p[2]) = share(mine[n], f, p); });
        build_all(box, &segments[n]);
        values[n].take(field, segments[n]);
      }
      std::vector<BoxExchange::Contribution> contributions;
      for (std::size_t n = 0; n < mine.size(); ++n) contributions.push_back({&values[n], &segments[n]});
      Field grid(domain, 3);
      for (int f = 0; f < 3; ++f) grid.fill(f, -0.0);
      ASSERT_EQ(exchange.add(contributions, {{&grid, 1}}), 0);
      std::ptrdiff_t wrong = 0;
      for (int f = 0; f < 3; ++f)
        for_each_point(domain, [&](const Int3 &p, const Int3 &) {
          const double a = grid[f](p[0], p[1], p[2]), b = expected[f](p[0], p[1], p[2]);
          wrong += a != b || std::signbit(a) != std::signbit(b);
        });
      EXPECT_EQ(wrong, 0) << "first " << first << (deal ? ", dealt out" : ", on one rank");
    }
}

// Every point of every box once, with all of its values, box after box.
TEST_P(BoxExchangeTest, CollectsInTheOrderOfNumbersWhoeverOwnsTheBoxes) {
  struct Seen {
    int number;
    std::ptrdiff_t offset;
    std::array<double, 3> values;
    bool operator<(const Seen &other) const {
      return std::tie(number, offset, values) < std::tie(other.number, other.offset, other.values);
    }
    bool operator==(const Seen &other) const {
      return std::tie(number, offset, values) == std::tie(other.number, other.offset, other.values);
    }
  };
  std::vector<Seen> expected;
  for (std::size_t b = 0; b < boxes.size(); ++b)
    for_each_point(boxes[b], [&](const Int3 &own, const Int3 &at) {
      const Int3 &begin = domain.layout().begin;
      const Int3 p{at[0] - begin[0], at[1] - begin[1], at[2] - begin[2]};
      for (int d = 0; d < 3; ++d)
        if (p[d] < 0 || p[d] >= domain.points_end(d, true)) return;
      expected.push_back({numbered({b})[0].number,
                          domain.layout().offset(p[0], p[1], p[2]),
                          {share(b, 0, own), share(b, 1, own), share(b, 2, own)}});
    });
  std::sort(expected.begin(), expected.end());
  BoxExchange exchange(domain, 3);
  for (const bool deal : {true, false}) {
    const std::vector<std::size_t> mine = owned(1, deal);
    ASSERT_EQ(exchange.connect(numbered(mine)), 0);
    Field field;  // of one box at a time
    const auto field_of = [&](std::size_t own_box) -> const Field & {
      const std::size_t b = mine[own_box];
      field = Field(boxes[b], 3);
      for (int f = 0; f < 3; ++f)
        for_each_point(boxes[b], [&](const Int3 &p, const Int3 &) { field[f](p[0], p[1], p[2]) = share(b, f, p); });
      return field;
    };
    std::vector<Seen> seen;
    ASSERT_EQ(exchange.collect(field_of,
                               [&](int number, std::ptrdiff_t offset, int count, const double *const *values) {
                                 EXPECT_TRUE(seen.empty() || seen.back().number <= number);
                                 for (int m = 0; m < count; ++m)
                                   seen.push_back({number, offset + m, {values[0][m], values[1][m], values[2][m]}});
                               }),
              0);
    std::sort(seen.begin(), seen.end());
    EXPECT_TRUE(seen == expected) << seen.size() << " points, not " << expected.size();
  }
}

INSTANTIATE_TEST_SUITE_P(SplitX, BoxExchangeTest, ::testing::Bool());

}  // namespace
}  // namespace eulastic
