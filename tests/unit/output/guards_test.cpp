// Guards against numbers measured by hand: each trips alone, and only beyond its bound.
#include "output/guards.hpp"
#include "support/scene.hpp"

#include <gtest/gtest.h>

using namespace eulastic;
using namespace eulastic::test;

namespace {

class GuardsTest : public ::testing::Test {
protected:
  void SetUp() override {
    GridSpec grid;
    grid.cells = {8, 6, 4};
    grid.length = {8, 3, 4};
    ASSERT_EQ(scene.create(PETSC_COMM_SELF, grid, SolverSpec{}), 0);
    ASSERT_EQ(scene.solver.prepare(), 0);
    State &state = scene.solver.state();
    state.velocity[0](5, 2, 1) = 2;
    state.velocity[1](1, 1, 1) = -1.5;  // |v|/h = 3
    state.step = 7;
    state.time = 1;
    state.dt = 0.1;
    good.flow.speed_max = 2;
    good.flow.kinetic_energy = 1;
    good.bodies.resize(3);
  }
  // What the guards say of `measured` after a good start.
  Stop check(const Measured &measured) {
    Guards guards(config);
    Stop stop;
    EXPECT_EQ(guards.check(scene.solver, good, &stop), 0);
    EXPECT_EQ(guards.check(scene.solver, good, &stop), 0);
    EXPECT_FALSE(stop) << stop.message;
    EXPECT_EQ(guards.check(scene.solver, measured, &stop), 0);
    return stop;
  }
  Scene scene;
  Config config;
  Measured good;
};

TEST_F(GuardsTest, EachTripsBeyondItsBoundOnly) {
  struct Case {
    double *bound, *value;
    const char *name;
  };
  Measured bad = good;
  bad.resolved_drift.label = 3;
  GuardControl &guard = config.guard;
  for (const Case &c : {Case{&guard.divergence, &bad.flow.divergence_rms, "-guard_divergence 0.25"},
                        Case{&guard.mach, &bad.mach, "-guard_mach 0.25"},
                        Case{&guard.energy_growth, &bad.energy_made, "-guard_energy_growth 0.25"},
                        Case{&guard.volume_drift, &bad.resolved_drift.value, "body 3"}}) {
    *c.bound = 0.25;
    const double usual = std::exchange(*c.value, 0.25);
    EXPECT_FALSE(check(bad)) << c.name;
    *c.value = 0.26;
    const Stop stop = check(bad);
    EXPECT_EQ(stop.reason, "guard");
    EXPECT_EQ(stop.message.rfind("step 7, t = 1, near x, y, z = ", 0), 0u) << stop.message;
    EXPECT_NE(stop.message.find(c.name), std::string::npos) << stop.message;
    EXPECT_NE(stop.message.find("-time_step"), std::string::npos) << stop.message;
    *c.value = std::nan("");
    EXPECT_TRUE(check(bad)) << c.name;
    *c.bound = 0;
    EXPECT_FALSE(check(bad)) << c.name;
    *c.value = usual;
  }
}

TEST_F(GuardsTest, FlowAtRestHasNoDivergenceToSpeakOf) {
  Measured rest = good;
  rest.flow.divergence_rms = 1;
  rest.flow.speed_max = 1e-9;  // a Courant number of 2e-10
  EXPECT_FALSE(check(rest));
}

TEST_F(GuardsTest, BeforeAStep) {
  const Guards guards(config);
  FlowExtremes extremes;
  extremes.speed = {2, 1.5, 0};
  Stop stop;
  ASSERT_EQ(guards.before_step(scene.solver, extremes, 0.19, &stop), 0);
  EXPECT_FALSE(stop) << stop.message;
  ASSERT_EQ(guards.before_step(scene.solver, extremes, 0.21, &stop), 0);  // 5 dt
  EXPECT_NE(stop.message.find("x, y, z = 1.5, 0.75, 1.5: CFL number 1.05"), std::string::npos) << stop.message;
  stop = {};
  ASSERT_EQ(guards.before_step(scene.solver, extremes, 1e-17, &stop), 0);
  EXPECT_NE(stop.message.find("too short to change the time"), std::string::npos) << stop.message;
  stop = {};
  extremes.first_non_finite = 8 + 1;
  ASSERT_EQ(guards.before_step(scene.solver, extremes, 0.19, &stop), 0);
  EXPECT_EQ(stop.reason, "nonfinite");
  EXPECT_NE(stop.message.find("x, y, z = 1.5, 0.75, 0.5: a field is not finite"), std::string::npos) << stop.message;
}

TEST_F(GuardsTest, Places) {
  Real3 place;
  ASSERT_EQ(place_of_speed(scene.domain, scene.solver.state().velocity, &place), 0);
  EXPECT_EQ(place, (Real3{1.5, 0.75, 1.5}));
  ASSERT_EQ(place_of_divergence(scene.domain, scene.solver.state().velocity, &place), 0);
  EXPECT_EQ(place, (Real3{1.5, 0.25, 1.5}));  // the face is the high one of the cell before
}

}  // namespace
