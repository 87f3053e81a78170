// Linear extrapolation of B at anchored bodies: docs/method.md, section 7.
#include "solids/exterior.hpp"
#include "support/scene.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

using namespace eulastic;
using namespace eulastic::test;

TEST(Exterior, LinearWhereViscosityDampsShortWaves) {
  for (const bool flat : {true, false}) {
    GridSpec spec;
    spec.cells = {8, 16, flat ? 1 : 4};
    spec.length = {4, 4, flat ? .1 : .5};
    Domain domain;
    ASSERT_EQ(domain.create(PETSC_COMM_SELF, spec), 0);
    const double shortest = flat ? .25 : .125;  // z does not count in 2-D
    Fluid fluid;
    fluid.density = 4;
    fluid.viscosity = 2;  // nu = 1/2
    Material material;
    const double most = fluid.density * .25 / (shortest * shortest);
    for (const double share : {.99, 1., 1.01}) {
      material.shear_modulus = share * most;
      EXPECT_EQ(damps_short_waves(domain.spacing(), domain.dimension(), fluid, material), share <= 1) << share;
    }
  }
}

TEST(Exterior, OnlyAttachedBodiesAreExtendedLinearly) {
  GridSpec grid;
  grid.cells = {8, 8, 1};
  SolverSpec spec;
  spec.fluid.viscosity = 1;  // h = 1/8: up to G = 64
  spec.exterior = SolidExterior::extrapolate;
  Scene scene;
  ASSERT_EQ(scene.create(PETSC_COMM_SELF, grid, spec), 0);
  const auto slab = [](double, double y, double) { return y < .5 ? 1. : 0.; };
  scene.add_phase(60, slab, true);
  scene.add_phase(70, slab, true);
  scene.add_phase(60, slab, false);
  ASSERT_EQ(scene.solver.prepare(), 0);
  const auto &phases = scene.solver.state().phases;
  EXPECT_TRUE(phases[0].tensor.rule.linear);
  EXPECT_FALSE(phases[1].tensor.rule.linear);
  EXPECT_FALSE(phases[2].tensor.rule.linear);
}

TEST(Exterior, LinesTakeTheSmallerSlope) {
  GridSpec grid;
  grid.cells = {8, 16, 1};
  grid.boundary[1] = Boundary::wall;
  Scene scene;
  SolverSpec spec;
  spec.exterior = SolidExterior::extrapolate;
  ASSERT_EQ(scene.create(PETSC_COMM_SELF, grid, spec), 0);
  scene.add_phase(
      1, [](double, double y, double) { return y < .5 ? 1. : 0.; }, true);
  ASSERT_EQ(scene.solver.prepare(), 0);
  Phase &phase = scene.solver.state().phases[0];
  ASSERT_TRUE(phase.tensor.rule.linear);
  ExteriorLayers layers;
  ASSERT_EQ(layers.build(scene.domain, phase), 0);
  constexpr int last = 6;  // row 7 has surface edges: centres up to 6 evolve
  struct Line {
    double third, second, first, next, after;
  };
  for (const Line &line : {Line{1, 2, 3, 4, 5}, Line{1.5, 2, 3, 3.5, 4}, Line{1, 2.5, 3, 3.5, 4}, Line{3, 2, 3, 3, 3},
                           Line{5, 4, 3, 2, 1}, Line{2, 2, 3, 3, 3}}) {
    const View xx = phase.tensor.field[0];
    for (int i = -3; i < 11; ++i) {
      xx.row(last - 2, 0)[i] = line.third;
      xx.row(last - 1, 0)[i] = line.second;
      xx.row(last, 0)[i] = line.first;
    }
    ASSERT_EQ(layers.extend(scene.domain, scene.solver.spec().sides, &scene.solver.exchange(), phase.tensor.field), 0);
    EXPECT_EQ(xx.row(last + 1, 0)[3], line.next);
    EXPECT_EQ(xx.row(last + 2, 0)[3], line.after);
  }
}

// A stretched disc around cell (m, n) of a periodic box, ready to step.
void create_disc(int m, int n, Scene *scene) {
  GridSpec grid;
  grid.cells = {32, 32, 1};
  grid.length = {32, 32, 1};
  ASSERT_EQ(scene->create(PETSC_COMM_SELF, grid, {method_preset(MethodKind::fast), {}, {}}), 0);
  const auto along = [](double x, int centre) { return std::remainder(x - centre, 32.); };
  const auto distance = [&](double x, double y) { return std::hypot(along(x, m), along(y, n)); };
  scene->add_phase(1, [&](double x, double y, double) { return std::clamp(6.5 - distance(x, y), 0., 1.); });
  Field &tensor = scene->solver.state().phases[0].tensor.field;
  for (int c = 0; c < tensor.count(); ++c)
    set(scene->domain, tensor[c], tensor_components(2)[c].at, [&](double x, double y, double) {
      return (c < 2 ? 1.2 : 0) + .1 * std::sin(c + along(x, m) / 3 + along(y, n) / 5);
    });
  ASSERT_EQ(scene->solver.prepare(), 0);
}

TEST(Exterior, IsTheSameAcrossPeriodicSides) {
  Scene inside;
  create_disc(16, 16, &inside);
  const Phase &expected = inside.solver.state().phases[0];
  EXPECT_NE(expected.tensor.field[0](16 + 8, 16, 0), 1);  // extended
  for (int shift = 0; shift < 64; ++shift) {              // along x, along the diagonal
    const int m = shift % 32, n = shift < 32 ? 16 : m;
    Scene across;
    create_disc(m, n, &across);
    const Phase &phase = across.solver.state().phases[0];
    for (int c = 0; c < phase.tensor.field.count(); ++c)
      for (int j = 0; j < 32; ++j)
        for (int i = 0; i < 32; ++i)
          ASSERT_NEAR(phase.tensor.field[c]((i + m) % 32, (j + n) % 32, 0),
                      expected.tensor.field[c]((i + 16) % 32, (j + 16) % 32, 0), 1e-13)
              << "B " << c << " at " << i << ", " << j << " of a disc at " << m << ", " << n;
  }
}
