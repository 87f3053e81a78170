// When B of attached bodies is extended linearly: docs/method.md, section 7.
#include "physics/exterior.hpp"
#include "support/scene.hpp"

#include <gtest/gtest.h>

using namespace eulastic;
using namespace eulastic::test;

TEST(Exterior, LinearWhereViscosityDampsShortWaves) {
  for (const bool flat : {true, false}) {
    GridSpec spec;
    spec.cells = {8, 16, flat ? 1 : 4};
    spec.length = {4, 4, flat ? .1 : .5};
    Grid grid;
    ASSERT_EQ(grid.create(PETSC_COMM_SELF, spec), 0);
    const double shortest = flat ? .25 : .125;  // z does not count in 2-D
    Fluid fluid;
    fluid.density = 4;
    fluid.viscosity = 2;  // nu = 1/2
    Material material;
    const double most = fluid.density * .25 / (shortest * shortest);
    for (const double share : {.99, 1., 1.01}) {
      material.shear_modulus = share * most;
      EXPECT_EQ(damps_short_waves(grid, fluid, material), share <= 1) << share;
    }
  }
}

TEST(Exterior, OnlyAttachedBodiesAreExtendedLinearly) {
  GridSpec grid;
  grid.cells = {8, 8, 1};
  SolverSpec spec;
  spec.fluid.viscosity = 1;  // h = 1/8: up to G = 64
  Scene scene;
  ASSERT_EQ(scene.create(PETSC_COMM_SELF, grid, spec), 0);
  const auto slab = [](double, double y, double) { return y < .5 ? 1. : 0.; };
  scene.add_phase(60, slab, true);
  scene.add_phase(70, slab, true);
  scene.add_phase(60, slab, false);
  ASSERT_EQ(scene.solver.prepare(), 0);
  const auto &phases = scene.solver.state().phases;
  EXPECT_TRUE(phases[0].material.linear);
  EXPECT_FALSE(phases[1].material.linear);
  EXPECT_FALSE(phases[2].material.linear);
}
