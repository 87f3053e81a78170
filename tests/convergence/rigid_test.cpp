// Rigid bodies against exact flows: a tube anywhere in the grid, a cylinder that turns in another, an array of discs;
// and nothing passes a wall of two cells.
#include "rigid/rigid_surfaces.hpp"
#include "support/rigid_scene.hpp"

#include <gtest/gtest.h>

using namespace eulastic;
using namespace eulastic::test;

namespace {

SolverSpec fast_solver(PressureKind pressure) {
  SolverSpec spec;
  static_cast<Method &>(spec) = method_preset(MethodKind::fast);
  spec.pressure = pressure;
  return spec;
}

// Relative error of the flow rate through a tube of `across` cells along x.
double tube(double across, PressureKind pressure) {
  const double radius = 0.385;
  const int cells = static_cast<int>(std::lround(across / (2 * radius)));
  Scene scene;
  GridSpec grid;
  grid.cells = {4, cells, cells};
  grid.length = {4. / cells, 1, 1};
  SolverSpec spec = fast_solver(pressure);
  spec.fluid.body_force.force = {1, 0, 0};
  EXPECT_EQ(scene.create(PETSC_COMM_SELF, grid, spec), 0);
  add_rigid(&scene, {rigid_body(Shape::tube, radius, {0, 0.513, 0.487}, 0)});
  EXPECT_EQ(scene.solver.prepare(), 0);
  EXPECT_EQ(scene.run(0.4, 100), 0);
  double flow = 0;
  for_points(scene.domain, scene.solver.state().velocity[0], at_face[0],
             [&](const double &u, double, double, double) { flow += u; });
  return flow / (4. * cells * cells) / (M_PI * std::pow(radius, 4) / 8) - 1;
}

TEST(RigidTube, FlowRateIsOfSecondOrder) {
  const double coarse = tube(10, PressureKind::acm), middle = tube(20, PressureKind::acm),
               fine = tube(40, PressureKind::acm);
  std::printf("  rigid tube of 10, 20, 40 cells across: flow rate %+.2e %+.2e %+.2e, order %.2f\n", coarse, middle,
              fine, 0.5 * order(std::fabs(coarse), std::fabs(fine)));
  EXPECT_LT(std::fabs(middle), 0.01);
  EXPECT_GT(0.5 * order(std::fabs(coarse), std::fabs(fine)), 1.8);
}

TEST(RigidTube, SolversAgree) {
  const double acm = tube(10, PressureKind::acm);
  EXPECT_NEAR(tube(10, PressureKind::smac), acm, 1e-7);
  EXPECT_NEAR(tube(10, PressureKind::ksp), acm, 1e-7);
}

struct Turning {
  double velocity;  // rms error, in parts of the speed of the inner cylinder
  double torque[2];
};

// The inner cylinder turns in the outer one, 2-D; from rest, or where inertia matters from the exact flow.
Turning turning(int cells, double viscosity = 1) {
  const double inner = 0.15, outer = 0.4, share = inner * inner / (outer * outer - inner * inner);
  const Real3 centre{0.513, 0.487, 0.5};
  Scene scene;
  GridSpec grid;
  grid.cells = {cells, cells, 1};
  SolverSpec spec = fast_solver(PressureKind::acm);
  spec.fluid.viscosity = viscosity;
  EXPECT_EQ(scene.create(PETSC_COMM_SELF, grid, spec), 0);
  const auto exact_speed = [&](double r) { return r < inner ? r : r > outer ? 0 : share * (outer * outer / r - r); };
  for (int d = 0; d < 2 && viscosity < 1; ++d)
    set(scene.domain, scene.solver.state().velocity[d], at_face[d], [&](double x, double y, double) {
      const double r = std::hypot(x - centre[0], y - centre[1]);
      return r > 0 ? (d == 0 ? centre[1] - y : x - centre[0]) / r * exact_speed(r) : 0;
    });
  SpeciesSpec rotor = rigid_body(Shape::sphere, inner, centre);
  rotor.motion.angular_velocity = {0, 0, 1};
  add_rigid(&scene, {rotor, rigid_body(Shape::tube, outer, centre)});
  EXPECT_EQ(scene.solver.prepare(), 0);
  EXPECT_EQ(viscosity < 1 ? scene.run(4, 200) : scene.run(1, 400), 0);
  double square = 0, points = 0;
  for_points(scene.domain, scene.solver.state().velocity[0], at_face[0],
             [&](const double &u, double x, double y, double) {
               const double r = std::hypot(x - centre[0], y - centre[1]);
               if (r < inner || r > outer) return;
               const double exact = -(y - centre[1]) / r * exact_speed(r);
               square += std::pow((u - exact) / inner, 2);
               points += 1;
             });
  std::vector<RigidLoad> loads;
  EXPECT_EQ(scene.solver.rigid_loads(&loads), 0);
  EXPECT_EQ(loads.size(), 2u);
  const double exact = 4 * M_PI * viscosity * share * outer * outer;
  // Power is that of now, torque the mean of the last step.
  std::vector<RigidLoad> next;
  EXPECT_EQ(scene.run(scene.solver.state().time + scene.solver.state().dt, 1), 0);
  EXPECT_EQ(scene.solver.rigid_loads(&next), 0);
  EXPECT_NEAR(loads[0].power, -loads[0].torque[2], 1e-12 + std::fabs(next[0].torque[2] - loads[0].torque[2]));
  return {std::sqrt(square / points), {-loads[0].torque[2] / exact - 1, loads[1].torque[2] / exact - 1}};
}

TEST(RigidCylinders, TorqueIsThatOfCouette) {
  const Turning coarse = turning(24), fine = turning(48);
  std::printf(
      "  cylinder turning in another, 4.8 and 9.6 cells in the radius: u %.2e %.2e, order %.2f; torques %+.2e %+.2e, "
      "%+.2e %+.2e\n",
      coarse.velocity, fine.velocity, order(coarse.velocity, fine.velocity), coarse.torque[0], coarse.torque[1],
      fine.torque[0], fine.torque[1]);
  EXPECT_LT(fine.velocity, 3e-3);
  EXPECT_GT(order(coarse.velocity, fine.velocity), 1.3);
  for (const double error : fine.torque) EXPECT_LT(std::fabs(error), 0.01);
}

// R^2 W/nu = 11: what fluid faces see of the body by advection is no friction.
TEST(RigidCylinders, TorqueIsThatOfCouetteWithInertia) {
  const Turning coarse = turning(24, 0.002), fine = turning(48, 0.002);
  std::printf("  cylinder turning at Re = 11, 3.6 and 7.2 cells in the radius: torque %+.2e %+.2e off\n",
              coarse.torque[0], fine.torque[0]);
  EXPECT_LT(std::fabs(fine.torque[0]), 0.02);
  EXPECT_LT(std::fabs(fine.torque[0]), 0.6 * std::fabs(coarse.torque[0]));
}

// Drag mu U K of a square array of cylinders at volume fraction .1: K = 24.83 (Sangani & Acrivos, Int. J. Multiphase
// Flow 8, 1982, table 1). All of the force on the box is drag, the body's own share included.
TEST(RigidCylinders, DragOfASquareArray) {
  const double volume = 0.1, radius = std::sqrt(volume / M_PI);
  Scene scene;
  GridSpec grid;
  grid.cells = {48, 48, 1};
  SolverSpec spec = fast_solver(PressureKind::smac);
  spec.fluid.inertia = false;
  spec.fluid.body_force.force = {1, 0, 0};
  EXPECT_EQ(scene.create(PETSC_COMM_SELF, grid, spec), 0);
  add_rigid(&scene, {rigid_body(Shape::cylinder, radius, {0.02, 0.99, 0.5})});  // across two sides
  EXPECT_EQ(scene.solver.prepare(), 0);
  EXPECT_EQ(scene.run(0.6, 200), 0);
  double flow = 0;
  for_points(scene.domain, scene.solver.state().velocity[0], at_face[0],
             [&](const double &u, double, double, double) { flow += u / (48. * 48); });
  std::vector<RigidLoad> loads;
  EXPECT_EQ(scene.solver.rigid_loads(&loads), 0);
  std::printf("  square array of cylinders, 8.6 cells in the radius: K %.3f (24.83), force %.4f (%.4f)\n", 1 / flow,
              loads[0].force[0], 1 - volume);
  EXPECT_NEAR(1 / flow, 24.83, 0.005 * 24.83);
  EXPECT_NEAR(loads[0].force[0], 1 - volume, 0.005);
  EXPECT_NEAR(loads[0].force[1], 0, 1e-3);
}

// A force that swings pushes against a wall of two cells in a channel: the pressure takes all of it.
TEST(RigidWall, NothingPassesTwoCells) {
  for (const PressureKind pressure : {PressureKind::smac, PressureKind::acm}) {
    Scene scene;
    GridSpec grid;
    grid.cells = {32, 16, 1};
    grid.length = {1, 0.5, 1};
    grid.boundary[1] = Boundary::wall;
    SolverSpec spec = fast_solver(pressure);
    spec.fluid.viscosity = 0.05;
    spec.fluid.body_force = {{1, 0, 0}, 6, 0};
    EXPECT_EQ(scene.create(PETSC_COMM_SELF, grid, spec), 0);
    SpeciesSpec wall;
    wall.shape = Shape::slab;
    wall.axis = 0;
    wall.interval = {0.51, 0.51 + 2. / 32};
    add_rigid(&scene, {wall});
    EXPECT_EQ(scene.solver.prepare(), 0);
    EXPECT_EQ(scene.run(0.9, 600), 0);
    double through = 0;
    for_points(scene.domain, scene.solver.state().velocity[0], at_face[0],
               [&](const double &u, double, double, double) { through += u / (32 * 16); });
    EXPECT_LT(std::fabs(through), pressure == PressureKind::smac ? 1e-13 : 1e-6);  // of .17 without the wall
    std::vector<RigidLoad> loads;
    EXPECT_EQ(scene.solver.rigid_loads(&loads), 0);
    const double force = 0.5 * std::cos(6 * 0.9);
    EXPECT_NEAR(loads[0].force[0], force * (1 - 2. / 32), 0.01 * 0.5);  // the pressure is that of a step before
  }
}

}  // namespace
