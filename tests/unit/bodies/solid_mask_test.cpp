// Cells of a body from a file and convex bodies beside them.
#include "bodies/solid_mask.hpp"
#include "grid/domain.hpp"

#include <gtest/gtest.h>

#include <cmath>

using namespace eulastic;

namespace {

// A mask of 70 x 6 x 5 cells of .5 x 1 x 2, periodic along x, with one cell in it.
SolidMask one_cell(const Int3 &cell) {
  GridSpec grid;
  grid.cells = {70, 6, 5};
  grid.length = {35, 6, 10};
  grid.boundary = {Boundary::periodic, Boundary::wall, Boundary::wall};
  SolidMask mask(grid);
  const double full = 1e-3;
  mask.add(CellWindow(grid, cell, {1, 1, 1}), ConstView{&full, 1, 1});
  return mask;
}

bool touches(const SolidMask &mask, const Real3 &centre, const Real3 &semi_axes) {
  SpeciesSpec spec;
  spec.shape = Shape::ellipsoid;
  spec.semi_axes = semi_axes;
  const ConvexBody body(spec, 3, 0);
  return mask.touches({&body, centre, rotation({})});
}

}  // namespace

TEST(SolidMask, FacesEdgesAndCorners) {
  const SolidMask mask = one_cell({66, 2, 3});  // x 33 ... 33.5, y 2 ... 3, z 6 ... 8; in the second word of its row
  const Real3 ball{0.5, 0.5, 0.5};
  for (const double gap : {-1e-3, 0.03}) {  // very close bodies count as touching
    const bool wanted = gap < 0;
    EXPECT_EQ(touches(mask, {33 - 0.5 - gap, 2.5, 7}, ball), wanted);
    EXPECT_EQ(touches(mask, {33.2, 3 + 0.5 + gap, 7.9}, ball), wanted);
    EXPECT_EQ(touches(mask, {33.2, 2.1, 6 - 0.5 - gap}, ball), wanted);
    const double s = (0.5 + gap) / std::sqrt(2.), t = (0.5 + gap) / std::sqrt(3.);
    EXPECT_EQ(touches(mask, {33.5 + s, 3 + s, 7}, ball), wanted);
    EXPECT_EQ(touches(mask, {33.5 + t, 2 - t, 8 + t}, ball), wanted);
  }
  EXPECT_TRUE(touches(mask, {33.2, 2.4, 6.5}, ball));  // inside
}

TEST(SolidMask, PeriodicSidesAndWalls) {
  const SolidMask mask = one_cell({0, 0, 0});
  EXPECT_TRUE(touches(mask, {34.6, 0.5, 1}, {0.5, 0.4, 0.4}));
  EXPECT_FALSE(touches(mask, {34.4, 0.5, 1}, {0.5, 0.4, 0.4}));
  EXPECT_FALSE(touches(mask, {0.25, 5.5, 1}, {0.4, 0.6, 0.4}));  // beyond a wall there is nothing
  EXPECT_TRUE(touches(mask, {17, 0.5, 1}, {17, 0.4, 0.4}));      // long bodies
  EXPECT_FALSE(touches(mask, {17.2, 3, 7}, {16, 1, 1}));
}
