// The whole step: moving scenes, and solids without stress.
#include "output/saved_state.hpp"
#include "support/polynomials.hpp"
#include "support/scene.hpp"

#include <gtest/gtest.h>

using namespace eulastic;
using namespace eulastic::test;

namespace {

// Difference to the same vortex and disc carried by a uniform velocity, after a quarter of the box.
double moving_frame_difference(int cells) {
  constexpr double k = 2 * 3.14159265358979323846, speed = 0.5, end = 0.5;
  Scene scene[2];
  for (int moving = 0; moving < 2; ++moving) {
    GridSpec grid;
    grid.cells = {cells, cells, 1};
    SolverSpec spec;
    spec.fluid.viscosity = 0.02;
    spec.pressure = PressureKind::smac;
    EXPECT_EQ(scene[moving].create(PETSC_COMM_SELF, grid, spec), 0);
    State &state = scene[moving].solver.state();
    set(scene[moving].domain, state.velocity[0], at_face[0],
        [=](double x, double y, double) { return moving * speed + 0.3 * std::sin(k * x) * std::cos(k * y); });
    set(scene[moving].domain, state.velocity[1], at_face[1],
        [=](double x, double y, double) { return -0.3 * std::cos(k * x) * std::sin(k * y); });
    scene[moving].add_phase(0.2, [=](double x, double y, double) {
      return 0.5 - 0.5 * std::tanh((std::hypot(x - 0.5, y - 0.4) - 0.2) * 16);
    });
    EXPECT_EQ(scene[moving].solver.prepare(), 0);
    EXPECT_EQ(scene[moving].run(end, cells * cells / 4), 0);
  }
  const ConstView still = scene[0].solver.state().velocity[0], moved = scene[1].solver.state().velocity[0];
  double sum = 0;
  for (int j = 0; j < cells; ++j)
    for (int i = 0; i < cells; ++i) sum += std::pow(moved((i + cells / 4) % cells, j, 0) - speed - still(i, j, 0), 2);
  return std::sqrt(sum) / cells / 0.3;
}

TEST(UniformVelocity, ChangesOnlyTheAdvectionError) {
  const double e[2] = {moving_frame_difference(32), moving_frame_difference(64)};
  std::printf("  moving frame at 32, 64: %.3e %.3e\n", e[0], e[1]);
  EXPECT_LT(e[1], 0.02);
  EXPECT_GT(e[1], 1e-8);
  EXPECT_GT(order(e[0], e[1]), 1);
}

// One step with an unstrained solid, and many steps with a solid without stiffness, have the bits of the pure fluid.
TEST(StresslessSolid, IsTheFluid) {
  for (const bool stiff : {true, false}) {
    Scene scene[2];
    for (int solid = 0; solid < 2; ++solid) {
      GridSpec grid;
      grid.cells = {13, 10, 9};
      grid.boundary[1] = Boundary::wall;
      SolverSpec spec;
      spec.fluid.viscosity = 0.1;
      spec.sides[1][0].motion.velocity = {0.5, 0, 0.2};
      ASSERT_EQ(scene[solid].create(PETSC_COMM_SELF, grid, spec), 0);
      Random random(1);
      for (int a = 0; a < 3; ++a)
        set(scene[solid].domain, scene[solid].solver.state().velocity[a], at_face[a],
            [&](double, double, double) { return 0.1 * random(); });
      if (solid) scene[solid].add_phase(stiff ? 1e3 : 0, [&](double, double, double) { return std::fabs(random()); });
      ASSERT_EQ(scene[solid].solver.prepare(), 0);
      ASSERT_EQ(stiff ? scene[solid].run(0.002, 1) : scene[solid].run(0.04, 20), 0);
    }
    scene[1].solver.state().phases.clear();
    std::uint64_t hash[2];
    ASSERT_EQ(state_hash(&scene[0].solver, &hash[0]), 0);
    ASSERT_EQ(state_hash(&scene[1].solver, &hash[1]), 0);
    EXPECT_EQ(hash[0], hash[1]) << "stiff " << stiff;
  }
}

}  // namespace
