// A Box is any block of cells: the part of a rank, or the surroundings of a body, which may begin anywhere, end at a
// boundary of the domain or extend across a periodic one.
#include "grid/box.hpp"

#include <gtest/gtest.h>

namespace eulastic {
namespace {

// 40 x 30 x 20 cells: x periodic, y between walls, z with an open high boundary.
DomainShape shape() {
  DomainShape shape;
  shape.cells = {40, 30, 20};
  shape.length = {4, 6, 1};
  shape.boundary = {Boundary::periodic, Boundary::wall, Boundary::wall};
  shape.open[2][1] = true;
  return shape;
}

TEST(Box, InTheMiddleOfTheDomainTouchesNothing) {
  const Box box(shape(), {7, 9, 5}, {6, 4, 3}, 5);
  EXPECT_EQ(box.cells(), (Int3{6, 4, 3}));
  EXPECT_EQ(box.domain_cells(), (Int3{40, 30, 20}));
  EXPECT_EQ(box.spacing(), (Real3{4. / 40, 6. / 30, 1. / 20}));
  EXPECT_DOUBLE_EQ(box.cell_volume(), .1 * .2 * .05);
  EXPECT_EQ(box.cell_count(), 72);
  EXPECT_FALSE(box.wraps_x());
  for (int d = 0; d < 3; ++d) {
    EXPECT_FALSE(box.spans(d));
    for (const bool high : {false, true}) {
      EXPECT_FALSE(box.touches(d, high));
      EXPECT_TRUE(box.boundary_faces(d, high).empty());
      EXPECT_TRUE(box.boundary_cells(d, high, 2).empty());
    }
    EXPECT_EQ(box.points_end(d, true), box.cells()[d]);
    EXPECT_EQ(box.points_end(d, true), box.cells()[d]);
  }
  EXPECT_TRUE(box.open_high_faces(2).empty());
  EXPECT_EQ(box.rows().size(), 12U);
}

TEST(Box, GhostsEndBehindSidesOfTheDomainOnly) {
  // begins across the periodic boundary, ends at the high wall in y
  const Box box(shape(), {-3, 2, 14}, {6, 28, 4}, 5);
  const auto near = [&](int d, bool staggered, int layers) {
    const Box::Range range = box.points_with_ghosts(d, staggered, layers);
    return std::array<int, 2>{range.begin, range.end};
  };
  EXPECT_EQ(near(0, true, 5), (std::array<int, 2>{-5, 11}));
  EXPECT_EQ(near(1, false, 5), (std::array<int, 2>{-2, 28}));
  EXPECT_EQ(near(1, true, 5), (std::array<int, 2>{-2, 29}));  // the face on the wall is a point
  EXPECT_EQ(near(1, true, 1), (std::array<int, 2>{-1, 29}));
  EXPECT_EQ(near(2, false, 5), (std::array<int, 2>{-5, 6}));  // two cells remain before the boundary
  EXPECT_EQ(near(2, true, 5), (std::array<int, 2>{-5, 7}));
  EXPECT_TRUE(box.touches(1, true));
  EXPECT_FALSE(box.touches(1, false));
  EXPECT_EQ(box.image(0, -3), 37);
  EXPECT_EQ(box.image(0, 41), 1);
  EXPECT_EQ(box.image(1, -2), -2);
}

TEST(Box, FacesAndCellsOnTheSidesThatItTouches) {
  const Box box(shape(), {0, 0, 17}, {40, 30, 3}, 3, true);
  EXPECT_TRUE(box.wraps_x());
  EXPECT_TRUE(box.spans(0) && box.spans(1) && !box.spans(2));
  ASSERT_EQ(box.open_high_faces(2).size(), 30U);
  for (const Segment &row : box.open_high_faces(2)) {
    EXPECT_EQ(row.k, 3);
    EXPECT_EQ(row.size(), 40);
  }
  EXPECT_TRUE(box.open_high_faces(1).empty());  // a wall is not open
  int points = 0;
  for_points(box.boundary_cells(1, true, 2), [&](int, int j, int) {
    EXPECT_GE(j, 28);
    ++points;
  });
  EXPECT_EQ(points, 40 * 2 * 3);
  EXPECT_EQ(box.points_end(2, true), 4);
  EXPECT_EQ(box.points_end(2, false), 3);
  EXPECT_TRUE(box.any_open());
  EXPECT_EQ(box.sides().size(), 4U);
}

TEST(Box, MemoryHasRoomForAllGhosts) {
  for (const Int3 &cells : {Int3{1, 1, 1}, Int3{6, 30, 4}, Int3{54, 7, 20}, Int3{40, 30, 20}}) {
    const Box box(shape(), {0, 0, 0}, cells, 5);
    const Layout &layout = box.layout();
    EXPECT_GE(layout.offset(-5, -5, -5), 0);
    EXPECT_LT(layout.offset(cells[0] + 4, cells[1] + 5, cells[2] + 5), layout.size);  // y and z have boundaries
    EXPECT_GE(layout.sy, cells[0] + 2 * 5);
    EXPECT_GE(layout.sz, layout.sy * (cells[1] + 2 * 5 + 1));
  }
  const Box flat({{16, 8, 1}, {2, 1, 1}, {}, {}}, {4, 0, 0}, {8, 8, 1}, 3);
  EXPECT_EQ(flat.dimension(), 2);
  EXPECT_EQ(flat.layout().ghosts, (Int3{3, 3, 0}));
  EXPECT_DOUBLE_EQ(flat.cell_volume(), .125 * .125);
}

}  // namespace
}  // namespace eulastic
