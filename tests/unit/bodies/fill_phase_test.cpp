// Phases at the start: fractions, labels and the stretch of placed bodies.
#include "bodies/fill_phase.hpp"
#include "bodies/shapes.hpp"
#include "field/boundaries.hpp"

#include <gtest/gtest.h>

namespace eulastic {
namespace {

GridSpec box(const Int3 &cells, const Real3 &length) {
  GridSpec spec;
  spec.cells = cells;
  spec.length = length;
  return spec;
}

SpeciesSpec species(Shape shape, double radius, const Real3 &centre) {
  SpeciesSpec spec;
  spec.name = "body";
  spec.shape = shape;
  spec.radius = radius;
  spec.semi_axes = {1.3 * radius, radius, 0.7 * radius};
  spec.centre = centre;
  spec.centre_given = true;
  return spec;
}

TEST(FillPhase, StretchAndLabelsWhereBodiesAre) {
  SpeciesSpec spec = species(Shape::sphere, 0.2, {});
  spec.placement = Placement::lattice;
  spec.count = {2, 1, 3};
  spec.initial_stretch = {2, 0.5, 1.5};
  spec.shear_modulus = 7;
  const GridSpec grid_spec = box({24, 12, 36}, {2, 1, 3});
  Places places;
  ASSERT_EQ(place_bodies(spec, grid_spec, &places), "");
  ASSERT_EQ(places.known.size(), 6u);
  Domain domain;
  ASSERT_EQ(domain.create(PETSC_COMM_SELF, grid_spec), 0);
  Phase phase;
  ASSERT_EQ(fill_phase(domain, spec, places, 10, &phase), 0);
  EXPECT_EQ(phase.material.shear_modulus, 7);
  ASSERT_EQ(phase.tensor.field.count(), 6);
  for (int k = 0; k < 36; ++k)
    for (int j = 0; j < 12; ++j)
      for (int i = 0; i < 24; ++i) {
        const bool solid = phase.fraction[0](i, j, k) > 0;
        EXPECT_EQ(phase.label[0](i, j, k), solid ? 10 + i / 12 + 2 * (k / 12) : 0);
        EXPECT_EQ(phase.tensor.field[0](i, j, k), solid ? 4 : 1);
        EXPECT_EQ(phase.tensor.field[1](i, j, k), solid ? 0.25 : 1);
        EXPECT_EQ(phase.tensor.field[2](i, j, k), solid ? 2.25 : 1);
        for (int c = 3; c < 6; ++c) EXPECT_EQ(phase.tensor.field[c](i, j, k), 0);
      }
  EXPECT_EQ(phase.label[0](6, 6, 30), 14);
}

TEST(FillPhase, StretchTurnsWithTheBody) {
  SpeciesSpec spec = species(Shape::ellipsoid, 0.25, {0.05, 0.5, 0.5});  // across the periodic x
  spec.initial_stretch = {1.5, 0.5, 4. / 3};
  spec.shear_modulus = 1;
  spec.orientation = {20, -35, 70};
  const GridSpec grid_spec = box({32, 32, 32}, {1, 1, 1});
  Places places;
  ASSERT_EQ(place_bodies(spec, grid_spec, &places), "");
  Domain domain;
  ASSERT_EQ(domain.create(PETSC_COMM_SELF, grid_spec), 0);
  Phase phase;
  ASSERT_EQ(fill_phase(domain, spec, places, 1, &phase), 0);
  const Rotation R = rotation(spec.orientation);
  const auto &components = tensor_components(3);
  int full[6] = {};
  for (std::size_t c = 0; c < 6; ++c) {
    const auto [a, b, at] = components[c];
    double expected = 0;
    for (int m = 0; m < 3; ++m) expected += R[a][m] * spec.initial_stretch[m] * spec.initial_stretch[m] * R[b][m];
    for (const Segment &row : domain.rows())
      for (int i = row.i_begin; i < row.i_end; ++i) {
        int solid = 0;  // of the cells around the point
        for (int n = 0; n < (a == b ? 1 : 4); ++n) {
          Int3 cell{i, row.j, row.k};
          if (n % 2) cell[a] = (cell[a] + 31) % 32;
          if (n / 2) cell[b] = (cell[b] + 31) % 32;
          solid += phase.fraction[0](cell[0], cell[1], cell[2]) > 0;
        }
        full[c] += solid > 0;
        ASSERT_NEAR(phase.tensor.field[static_cast<int>(c)](i, row.j, row.k), solid > 0 ? expected : a == b, 1e-14)
            << c << " at " << i << ' ' << row.j << ' ' << row.k;
      }
  }
  for (const int count : full) EXPECT_GT(count, 1000);
}

TEST(FillPhase, OverlappingBodiesTakeTheLargerFraction) {
  SpeciesSpec spec = species(Shape::sphere, 0.3, {});
  std::vector<BodyPlace> places{{{0.4, 0.5, 0.5}, {}}, {{0.62, 0.5, 0.5}, {}}};
  Domain domain;
  ASSERT_EQ(domain.create(PETSC_COMM_SELF, box({20, 20, 20}, {1, 1, 1})), 0);
  Phase both, one[2];
  ASSERT_EQ(fill_phase(domain, spec, places, 1, &both), 0);
  for (int b = 0; b < 2; ++b) ASSERT_EQ(fill_phase(domain, spec, {places[b]}, 1 + b, &one[b]), 0);
  for (const Segment &row : domain.rows())
    for (int i = row.i_begin; i < row.i_end; ++i) {
      const double a = one[0].fraction[0](i, row.j, row.k), b = one[1].fraction[0](i, row.j, row.k);
      EXPECT_EQ(both.fraction[0](i, row.j, row.k), std::max(a, b));
      EXPECT_EQ(both.label[0](i, row.j, row.k), a >= b && a > 0 ? 1 : b > 0 ? 2 : 0);
    }
}

}  // namespace
}  // namespace eulastic
