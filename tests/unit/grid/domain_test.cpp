// Decompositions, error messages of impossible ones, and the memory layout of one rank.
#include "grid/domain.hpp"
#include "field/field.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>

namespace eulastic {
namespace {

GridSpec box(const Int3 &cells, const Int3 &processors = {0, 0, 0}) {
  GridSpec spec;
  spec.cells = cells;
  spec.processors = processors;
  return spec;
}

TEST(GridDecomposition, TakesZThenYThenX) {
  EXPECT_EQ(Domain::decompose(box({64, 64, 64}), 1), (Int3{1, 1, 1}));
  EXPECT_EQ(Domain::decompose(box({64, 64, 64}), 4), (Int3{1, 1, 4}));  // 2 x 2 has as many ghosts, not contiguous
  EXPECT_EQ(Domain::decompose(box({64, 64, 64}), 8), (Int3{1, 2, 4}));
  EXPECT_EQ(Domain::decompose(box({64, 64, 64}), 64), (Int3{1, 8, 8}));
  EXPECT_EQ(Domain::decompose(box({64, 64, 1}), 4), (Int3{1, 4, 1}));
  EXPECT_EQ(Domain::decompose(box({5, 9, 7}), 2), (Int3{1, 2, 1}));  // 7 ghosts per x rather than 9
  EXPECT_EQ(Domain::decompose(box({5, 9, 7}), 3), (Int3{1, 3, 1}));  // 7 cells do not make three times 3
  EXPECT_EQ(Domain::decompose(box({5, 9, 7}), 4), (Int3{1, 2, 2}));
}

TEST(GridDecomposition, SplitsXOnlyWhenItMust) {
  EXPECT_EQ(Domain::decompose(box({20, 5, 1}), 4), (Int3{4, 1, 1}));
  EXPECT_EQ(Domain::decompose(box({20, 13, 1}), 4), (Int3{1, 4, 1}));
  EXPECT_EQ(Domain::decompose(box({20, 13, 1}), 6), (Int3{2, 3, 1}));
  EXPECT_EQ(Domain::decompose(box({20, 13, 1}), 5), (Int3{5, 1, 1}));
}

// x is split in whole blocks of the exact sums where whole rows would have many more ghosts.
TEST(GridDecomposition, SplitsALongXInBlocks) {
  const GridSpec paper = box({24576, 5184, 5120});
  const Int3 best = Domain::decompose(paper, 82944), rank = Domain::largest_box(paper, best);
  EXPECT_EQ(best[0] * best[1] * best[2], 82944);
  EXPECT_EQ(rank[0] % 256, 0);
  const auto ghosts = [](const Int3 &n) { return double(n[0]) * n[1] + double(n[1]) * n[2] + double(n[0]) * n[2]; };
  EXPECT_LT(ghosts(rank), 0.3 * ghosts({24576, 18, 20}));
  EXPECT_EQ(Domain::decompose(box({1024, 64, 64}), 16), (Int3{4, 1, 4}));  // 17408 a layer, 32768 with a whole x
  EXPECT_EQ(Domain::decompose(box({512, 512, 512}), 16)[0], 1);            // 131072 and 163840
  EXPECT_EQ(Domain::decompose(box({510, 64, 64}), 256)[0], 1);             // less than two blocks
  EXPECT_EQ(Domain::decompose(box({1024, 1024, 1}), 16), (Int3{4, 4, 1}));
  EXPECT_EQ(Domain::decompose(box({1024, 1024, 1}, {1, 0, 0}), 16), (Int3{1, 16, 1}));
}

TEST(GridDecomposition, ObeysOrders) {
  EXPECT_EQ(Domain::decompose(box({64, 64, 64}, {2, 0, 0}), 4), (Int3{2, 1, 2}));
  EXPECT_EQ(Domain::decompose(box({64, 64, 64}, {0, 4, 0}), 4), (Int3{1, 4, 1}));
  EXPECT_EQ(Domain::decompose(box({64, 64, 64}, {0, 0, 2}), 4), (Int3{1, 2, 2}));
  EXPECT_EQ(Domain::decompose(box({64, 64, 64}, {4, 1, 1}), 4), (Int3{4, 1, 1}));
  EXPECT_EQ(Domain::decompose(box({64, 64, 64}, {2, 2, 0}), 3), (Int3{0, 0, 0}));
  EXPECT_EQ(Domain::decompose(box({64, 64, 1}, {0, 0, 2}), 4), (Int3{0, 0, 0}));
  EXPECT_EQ(Domain::decompose(box({64, 64, 64}, {-1, 0, 0}), 4), (Int3{0, 0, 0}));
}

// Every decomposition has the right number of ranks and at least 3 cells per rank; it is refused only if there is no
// product of ranks with 3 cells each.
TEST(GridDecomposition, AnswersExactlyWhenThereIsAnAnswer) {
  for (const Int3 &cells : {Int3{13, 10, 11}, Int3{5, 9, 7}, Int3{17, 12, 1}, Int3{3, 3, 3}, Int3{520, 4, 3}})
    for (int ranks = 1; ranks <= 40; ++ranks) {
      const GridSpec spec = box(cells);
      const Int3 best = Domain::decompose(spec, ranks);
      bool possible = false;
      for (int px = 1; px <= ranks; ++px)
        for (int py = 1; px * py <= ranks; ++py)
          if (ranks % (px * py) == 0) {
            const int pz = ranks / (px * py);
            possible |= px <= cells[0] / 3 && py <= cells[1] / 3 && (cells[2] == 1 ? pz == 1 : pz <= cells[2] / 3);
          }
      EXPECT_EQ(best[0] > 0, possible) << cells[0] << " cells in x, " << ranks << " ranks";
      EXPECT_EQ(Domain::refusal_reason(spec, ranks).empty(), possible);
      if (best[0] == 0) continue;
      EXPECT_EQ(best[0] * best[1] * best[2], ranks);
      for (int d = 0; d < 3; ++d) EXPECT_GE(cells[d] / best[d], d == 2 && cells[2] == 1 ? 1 : 3);
    }
}

TEST(GridDecomposition, SaysWhyNot) {
  EXPECT_EQ(Domain::refusal_reason(box({64, 64, 64}), 4), "");
  const std::string few = "; accepted: at least 3 in x and y, 1 (2-D) or at least 3 in z";
  EXPECT_EQ(Domain::refusal_reason(box({8, 2, 8}), 1), "-grid_cells: 2 in y" + few);
  EXPECT_EQ(Domain::refusal_reason(box({8, 8, 2}), 1), "-grid_cells: 2 in z" + few);
  EXPECT_EQ(Domain::refusal_reason(box({0, 8, 1}), 1), "-grid_cells: 0 in x" + few);
  EXPECT_EQ(
      Domain::refusal_reason(box({5, 5, 5}), 2),
      "-grid_cells: 2 ranks cannot share 5 x 5 x 5 cells; accepted: at least 3 cells per rank in every direction");
  EXPECT_EQ(
      Domain::refusal_reason(box({64, 64, 64}, {2, 2, 0}), 3),
      "-da_processors_x, _y, _z: 3 ranks cannot share 64 x 64 x 64 cells as 2 x 2 x 0 ranks (0 = free); accepted: "
      "a product of 3, and at least 3 cells per rank in every direction");
}

TEST(GridGeometry, SpacingVolumeAndWalls) {
  GridSpec spec = box({8, 4, 5});
  spec.length = {2, 3, 10};
  spec.boundary = {Boundary::periodic, Boundary::wall, Boundary::wall};
  Domain domain;
  ASSERT_EQ(domain.create(PETSC_COMM_SELF, spec), 0);
  EXPECT_EQ(domain.spacing(), (Real3{.25, .75, 2}));
  EXPECT_EQ(domain.cell_volume(), .375);
  EXPECT_EQ(domain.domain_cell_count(), 160);
  EXPECT_EQ(domain.dimension(), 3);
  EXPECT_FALSE(domain.is_wall(0) || domain.touches_low(0) || domain.touches_high(0));
  EXPECT_TRUE(domain.is_wall(1) && domain.touches_low(1) && domain.touches_high(1));
  EXPECT_EQ(domain.points_end(0, true), 8);
  EXPECT_EQ(domain.points_end(1, true), 5);
  EXPECT_EQ(domain.points_end(1, false), 4);

  spec.cells[2] = 1;  // 2-D: a wall in z is ignored
  ASSERT_EQ(domain.create(PETSC_COMM_SELF, spec), 0);
  EXPECT_EQ(domain.dimension(), 2);
  EXPECT_EQ(domain.cell_volume(), .1875);
  EXPECT_FALSE(domain.is_wall(2) || domain.touches_low(2) || domain.touches_high(2));
  EXPECT_EQ(domain.points_end(2, true), 1);
  EXPECT_EQ(domain.layout().ghosts, (Int3{5, 5, 0}));
}

TEST(GridGeometry, RowsAreAllOwnedCellsOnce) {
  Domain domain;
  ASSERT_EQ(domain.create(PETSC_COMM_SELF, box({5, 4, 3})), 0);
  std::vector<int> seen(60);
  for (const Segment &row : domain.rows())
    for (int i = row.i_begin; i < row.i_end; ++i) ++seen.at(i + 5 * (row.j + 4 * row.k));
  EXPECT_EQ(seen, std::vector<int>(60, 1));
}

// Rows start on 64-byte lines, strides avoid large powers of two, and no two points of a block share memory.
TEST(FieldLayout, AlignedAndWithoutOverlap) {
  for (const Int3 &cells :
       {Int3{3, 3, 3}, Int3{5, 9, 7}, Int3{8, 4, 1}, Int3{58, 10, 4}, Int3{50, 58, 3}, Int3{250, 3, 1}}) {
    Domain domain;
    ASSERT_EQ(domain.create(PETSC_COMM_SELF, box(cells)), 0);
    const Layout &own = domain.layout();
    const int fields = 3;
    Field block(domain, fields);
    EXPECT_EQ(block.bytes(), sizeof(double) * own.size * fields);
    EXPECT_NE(own.sy % 64, 0);
    EXPECT_NE(own.sz % 512, 0);
    std::vector<int> used(own.size * fields);
    for (int f = 0; f < fields; ++f)
      for (int k = -own.ghosts[2]; k < cells[2] + own.ghosts[2]; ++k)
        for (int j = -own.ghosts[1]; j < cells[1] + own.ghosts[1]; ++j) {
          EXPECT_EQ(reinterpret_cast<std::uintptr_t>(block[f].row(j, k)) % 64, 0u);
          for (int i = -own.ghosts[0]; i < cells[0] + own.ghosts[0]; ++i) {
            const std::ptrdiff_t at = &block[f](i, j, k) - block.data();
            EXPECT_EQ(at, own.offset(i, j, k) + f * own.size);
            ++used.at(at);
          }
        }
    for (const int times : used) EXPECT_LE(times, 1);
  }
}

TEST(FieldLayout, StartsAtZeroFillsOneFieldSwapsAndMoves) {
  Domain domain;
  ASSERT_EQ(domain.create(PETSC_COMM_SELF, box({5, 4, 3})), 0);
  Field a(domain, 2), b(domain, 1);
  const std::ptrdiff_t size = domain.layout().size;
  for (std::ptrdiff_t n = 0; n < 2 * size; ++n) ASSERT_EQ(a.data()[n], 0);
  a.fill(1, 7);
  for (std::ptrdiff_t n = 0; n < 2 * size; ++n) ASSERT_EQ(a.data()[n], n < size ? 0 : 7);
  a.swap(b);
  EXPECT_EQ(a.count(), 1);
  EXPECT_EQ(b.count(), 2);
  EXPECT_EQ(b[1](-3, -3, -3), 7);
  const Field c = std::move(b);
  EXPECT_TRUE(c && a);
  EXPECT_FALSE(b || Field());  // a block that was moved away is empty NOLINT(bugprone-use-after-move)
}

}  // namespace
}  // namespace eulastic
