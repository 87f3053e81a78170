// Tubes and constricted tubes: exact volumes, where they are, refusals.
#include "bodies/fill_phase.hpp"
#include "bodies/shapes.hpp"

#include <gtest/gtest.h>

#include <cmath>

using namespace eulastic;

namespace {

GridSpec box(const Int3 &cells, const Real3 &length) {
  GridSpec spec;
  spec.cells = cells;
  spec.length = length;
  return spec;
}

SpeciesSpec tube(int axis, double radius, const Real3 &centre) {
  SpeciesSpec spec;
  spec.shape = Shape::tube;
  spec.axis = axis;
  spec.radius = radius;
  spec.centre = centre;
  spec.centre_given = true;
  return spec;
}

SpeciesSpec constricted(int axis, double radius, const Real3 &centre, double throat, double length) {
  SpeciesSpec spec = tube(axis, radius, centre);
  spec.shape = Shape::constricted_tube;
  spec.throat_radius = throat;
  spec.throat_length = length;
  return spec;
}

// Volume of the phase; checks that it is anchored and named.
double volume(const SpeciesSpec &spec, const GridSpec &grid_spec) {
  Places places;
  EXPECT_EQ(place_bodies(spec, grid_spec, &places), "");
  EXPECT_EQ(places.known.size(), 1u);
  Domain domain;
  EXPECT_EQ(domain.create(PETSC_COMM_SELF, grid_spec), 0);
  Phase phase;
  EXPECT_EQ(fill_phase(domain, spec, places, 1, &phase), 0);
  EXPECT_TRUE(phase.material.anchored);
  double sum = 0;
  for (const Segment &row : domain.rows())
    for (int i = row.i_begin; i < row.i_end; ++i) sum += phase.fraction[0](i, row.j, row.k);
  return sum * domain.cell_volume();
}

std::string refusal_reason(const SpeciesSpec &spec, const GridSpec &grid) {
  Places places;
  return place_bodies(spec, grid, &places);
}

}  // namespace

TEST(Tube, HasTheVolumeOutsideTheLumen) {
  const double pi = M_PI, h[2] = {2.4 / 24, 2.4 / 48};
  for (int axis = 0; axis < 3; ++axis) {
    Int3 cells{30, 30, 30};
    cells[axis] = 4;
    const GridSpec grid = box(cells, {2.4, 2.6, 2.8});
    const SpeciesSpec spec = tube(axis, 1.1, {1.2, 1.31, 1.41});
    const double exact = 2.4 * 2.6 * 2.8 - pi * 1.21 * grid.length[axis];
    EXPECT_NEAR(volume(spec, grid), exact, 1e-6 * exact);
    EXPECT_DOUBLE_EQ(volume_in_box(spec, grid), exact);
  }
  // In 2-D: a channel along x, the outside of a disc along z.
  EXPECT_NEAR(volume(tube(0, 0.7, {1, 1.03, 9}), box({8, 20, 1}, {2, 2, 1})), 2 * (2 - 1.4), 1e-12);
  EXPECT_NEAR(volume(tube(2, 0.7, {1, 1.03, 9}), box({20, 20, 1}, {2, 2, 1})), 4 - pi * 0.49, 2e-5);
  // Constricted: R = 1, throat .4 over 1.5, L = 2.
  double last = 0;
  for (const int n : {0, 1}) {
    const int cells = n ? 48 : 24;
    const SpeciesSpec spec = constricted(1, 1, {1.21, 1.03, 1.19}, 0.4, 1.5);
    const GridSpec grid = box({cells, cells * 5 / 6, cells}, {2.4, 2, 2.4});
    double lumen = 0;  // midpoint rule: exact to round-off for a trigonometric polynomial over its period
    for (int s = 0; s < 64; ++s) {
      const double r = 1 - 0.6 * (1 + std::cos(2 * pi * ((s + 0.5) / 64 - 0.5))) / 2;
      lumen += pi * r * r * 1.5 / 64;
    }
    lumen += pi * 0.5;
    EXPECT_NEAR(lumen_volume(spec, grid), lumen, 1e-12);
    const double error = std::abs(volume(spec, grid) / (2.4 * 2 * 2.4 - lumen) - 1);
    std::printf("  constricted tube, h = %.3f: volume wrong by %.1e\n", h[n], error);
    EXPECT_LT(error, n ? 1e-6 : 1e-5);
    last = error;
  }
  EXPECT_GT(last, 0);
  EXPECT_NEAR(volume(constricted(0, 0.8, {1, 1, 9}, 0.3, 1.2), box({40, 40, 1}, {2, 2, 1})),
              4 - 2 * (0.8 * 2 - 0.5 * 1.2 / 2), 1e-4);
}

TEST(Tube, IsZeroInsideAndOneOutside) {
  const GridSpec spec = box({40, 24, 24}, {5, 3, 3});
  const SpeciesSpec throat = constricted(0, 1.4, {2.5, 1.5, 1.5}, 0.5, 3);
  EXPECT_DOUBLE_EQ(lumen_radius(throat, 0), 0.5);
  EXPECT_DOUBLE_EQ(lumen_radius(throat, 0.75), 0.95);
  EXPECT_DOUBLE_EQ(lumen_radius(throat, -1.6), 1.4);
  Places places;
  ASSERT_EQ(place_bodies(throat, spec, &places), "");
  Domain domain;
  ASSERT_EQ(domain.create(PETSC_COMM_SELF, spec), 0);
  Phase phase;
  ASSERT_EQ(fill_phase(domain, throat, places, 3, &phase), 0);
  int cut = 0;
  for (int k = 0; k < 24; ++k)
    for (int j = 0; j < 24; ++j)
      for (int i = 0; i < 40; ++i) {
        const double r = std::hypot((j + 0.5) / 8 - 1.5, (k + 0.5) / 8 - 1.5);
        const double wall = lumen_radius(throat, (i + 0.5) / 8 - 2.5), phi = phase.fraction[0](i, j, k);
        const double reach = 0.0625 * (std::sqrt(2.0) + 0.95);  // half a cell across, and along the steepest slope
        if (r < wall - reach) {
          EXPECT_EQ(phi, 0.0);
        } else if (r > wall + reach) {
          EXPECT_EQ(phi, 1.0);
        } else {
          ++cut;
        }
        EXPECT_EQ(phase.label[0](i, j, k), phi > 0 ? 3.0 : 0.0);
      }
  EXPECT_GT(cut, 1000);
}

TEST(Tube, RefusesALumenThatLeavesTheBox) {
  const GridSpec grid = box({16, 16, 16}, {4, 4, 4});
  EXPECT_EQ(refusal_reason(tube(0, 2, {2, 2, 2}), grid), "");
  EXPECT_NE(refusal_reason(tube(0, 2, {2, 2.1, 2}), grid).find("lumen leaves the box: y"), std::string::npos);
  EXPECT_NE(refusal_reason(constricted(0, 1, {1, 2, 2}, 0.5, 3), grid).find("throat leaves the box: x"),
            std::string::npos);
  SpeciesSpec turned = tube(0, 1, {2, 2, 2});
  turned.orientation = {0, 0, 90};
  EXPECT_NE(refusal_reason(turned, grid).find("cannot be rotated"), std::string::npos);
}
