// Rigid bodies that travel through the grid: against the exact force on a cylinder that swings in another, and against
// the same cylinder at rest in a fluid that comes to it.
#include "rigid/rigid_surfaces.hpp"
#include "support/rigid_scene.hpp"

#include <gtest/gtest.h>

#include <complex>

using namespace eulastic;
using namespace eulastic::test;

namespace {

SolverSpec fast_solver(double viscosity, bool inertia) {
  SolverSpec spec;
  static_cast<Method &>(spec) = method_preset(MethodKind::fast);
  spec.fluid.viscosity = viscosity;
  spec.fluid.inertia = inertia;
  return spec;
}

struct Force {
  std::vector<double> time, value;  // along x, at the times of the pressure
};

Force force_on_first(Scene *scene, double end, int steps) {
  Force force;
  std::vector<RigidLoad> loads;
  EXPECT_EQ(scene->solver.prepare(), 0);
  const double dt = end / steps;
  for (int n = 1; n <= steps; ++n) {
    EXPECT_EQ(scene->run(n * dt, 1), 0);
    EXPECT_EQ(scene->solver.rigid_loads(&loads), 0);
    force.time.push_back((n - 0.5) * dt);
    force.value.push_back(loads[0].force[0]);
  }
  return force;
}

struct Swing {
  std::complex<double> first;  // harmonic, in parts of the exact one
  double largest;              // difference of any step from it
};

// Radii .125 and .45, U = V cos(w t), w = 2 pi, nu = .00307, Stokes' equations: with psi = (A r + B/r + C I1(k r) + D
// K1(k r)) sin(theta), k^2 = i w/nu, and no slip on both, F/V = -.2214776 - .5428159 i. The way is .1 radii each way.
Swing swing(int cells, int steps) {
  const std::complex<double> exact{-0.2214776, -0.5428159};
  const double w = 2 * M_PI, V = 0.0125 * w, nu = 0.00307;
  const Real3 centre{0.503, 0.497, 0.5};
  Scene scene;
  GridSpec grid;
  grid.cells = {cells, cells, 1};
  EXPECT_EQ(scene.create(PETSC_COMM_SELF, grid, fast_solver(nu, false)), 0);
  SpeciesSpec ball = rigid_body(Shape::sphere, 0.125, centre);
  ball.motion.velocity = {V, 0, 0};
  ball.motion.of_velocity = {w, -M_PI / 2};  // from rest
  add_rigid(&scene, {ball, rigid_body(Shape::tube, 0.45, centre)});
  const Force force = force_on_first(&scene, 2, 2 * steps);
  std::complex<double> sum = 0;
  for (std::size_t n = steps; n < force.time.size(); ++n)
    sum += 2. / steps * force.value[n] * std::polar(1., -(w * force.time[n] - M_PI / 2));
  Swing found{sum / (exact * V), 0};
  for (std::size_t n = steps; n < force.time.size(); ++n) {
    const double smooth = (sum * std::polar(1., w * force.time[n] - M_PI / 2)).real();
    found.largest = std::max(found.largest, std::fabs(force.value[n] - smooth) / std::abs(exact * V));
  }
  return found;
}

TEST(TravellingCylinder, SwingsInAnother) {
  const Swing coarse = swing(64, 60), fine = swing(128, 120);
  std::printf(
      "  cylinder swinging in another, 8 and 16 cells in the radius: force %.2e %.2e off; largest step %.2e %.2e\n",
      std::abs(coarse.first - 1.), std::abs(fine.first - 1.), coarse.largest, fine.largest);
  EXPECT_LT(std::abs(coarse.first - 1.), 0.02);
  EXPECT_LT(std::abs(fine.first - 1.), 0.01);
  EXPECT_LT(coarse.largest, 0.04);
  EXPECT_LT(fine.largest, 0.02);
}

// Re = 40: a cylinder that is carried through fluid at rest, and one at rest in fluid that moves at first.
Force through_the_box(int cells, bool travels, int steps) {
  Scene scene;
  GridSpec grid;
  grid.cells = {cells, cells, 1};
  EXPECT_EQ(scene.create(PETSC_COMM_SELF, grid, fast_solver(0.005, true)), 0);
  SpeciesSpec ball = rigid_body(Shape::sphere, 0.1, {0.703, 0.503, 0.5});
  if (travels)
    ball.motion.velocity = {1, 0, 0};
  else
    set(scene.domain, scene.solver.state().velocity[0], at_face[0], [](double, double, double) { return -1; });
  add_rigid(&scene, {ball});
  return force_on_first(&scene, 0.6, steps);
}

TEST(TravellingCylinder, IsOneAtRestInAStream) {
  double mean[2], scatter[2];
  for (int n = 0; n < 2; ++n) {
    const int cells = 64 << n, steps = 240 << n;
    const Force travels = through_the_box(cells, true, steps), rests = through_the_box(cells, false, steps);
    double sum = 0, squares = 0, drag = 0;
    for (std::size_t s = steps / 4; s < travels.value.size(); ++s) {
      const double off = travels.value[s] - rests.value[s];
      sum += off;
      squares += off * off;
      drag += rests.value[s];
    }
    const double count = 0.75 * steps;
    mean[n] = sum / drag;
    scatter[n] = std::sqrt(squares / count - std::pow(sum / count, 2)) / std::fabs(drag / count);
  }
  std::printf(
      "  cylinder through fluid at rest, 6.4 and 12.8 cells in the radius: drag %+.2e %+.2e off, scatter %.2e %.2e\n",
      mean[0], mean[1], scatter[0], scatter[1]);
  EXPECT_LT(std::fabs(mean[0]), 0.01);
  EXPECT_LT(std::fabs(mean[1]), 0.005);
  EXPECT_LT(scatter[0], 0.05);
  EXPECT_LT(scatter[1], 0.7 * scatter[0]);
}

// What it exerts on fluid at rest in a periodic box is the momentum that this gains.
TEST(TravellingCylinder, ForceIsThatOfTheMomentum) {
  double off[2];
  for (int n = 0; n < 2; ++n) {
    const int cells = 64 << n, steps = 240 << n;
    Scene scene;
    GridSpec grid;
    grid.cells = {cells, cells, 1};
    EXPECT_EQ(scene.create(PETSC_COMM_SELF, grid, fast_solver(0.005, true)), 0);
    SpeciesSpec ball = rigid_body(Shape::sphere, 0.1, {0.703, 0.503, 0.5});
    ball.motion.velocity = {1, 0, 0};
    add_rigid(&scene, {ball});
    const auto momentum = [&] {
      double sum = 0;
      for_points(scene.domain, scene.solver.state().velocity[0], at_face[0],
                 [&](const double &u, double, double, double) { sum += u; });
      return sum / (double(cells) * cells);
    };
    EXPECT_EQ(scene.solver.prepare(), 0);
    std::vector<RigidLoad> loads;
    double impulse = 0, before = 0;
    for (int s = 1; s <= steps; ++s) {
      EXPECT_EQ(scene.run(0.6 * s / steps, 1), 0);
      if (4 * s < steps) continue;
      if (4 * s == steps) before = momentum();
      EXPECT_EQ(scene.solver.rigid_loads(&loads), 0);
      if (4 * s > steps) impulse -= loads[0].force[0] * 0.6 / steps;
    }
    off[n] = impulse / (momentum() - before) - 1;
  }
  std::printf(
      "  cylinder through fluid at rest, 6.4 and 12.8 cells in the radius: force %+.2e %+.2e off the momentum's rate\n",
      off[0], off[1]);
  EXPECT_LT(std::fabs(off[0]), 0.01);
  EXPECT_LT(std::fabs(off[1]), 0.005);
}

// An ellipse turns in a round vessel at rest; in its own frame the vessel turns the other way. In 2-D the torque is the
// same: what the frame adds to the pressure has none. Mean over a third of a turn from the first radian on.
struct Torque {
  double mean, scatter;  // parts of the mean
  double vessel;         // mean of that on the vessel
};

Torque turning(int cells, bool turns, bool file) {
  const Real3 centre{0.503, 0.497, 0.5};
  Scene scene;
  GridSpec grid;
  grid.cells = {cells, cells, 1};
  EXPECT_EQ(scene.create(PETSC_COMM_SELF, grid, fast_solver(0.02, true)), 0);
  SpeciesSpec paddle = rigid_body(Shape::ellipsoid, 0, centre), vessel = rigid_body(Shape::tube, 0.4, centre);
  paddle.semi_axes = {0.25, 0.12, 1};
  (turns ? paddle : vessel).motion.angular_velocity = {0, 0, turns ? 1. : -1.};
  for (int d = 0; d < 2 && !turns; ++d)
    set(scene.domain, scene.solver.state().velocity[d], at_face[d],
        [&](double x, double y, double) { return d == 0 ? y - centre[1] : centre[0] - x; });
  add_rigid(&scene, {paddle, vessel}, file);
  EXPECT_EQ(scene.solver.prepare(), 0);
  std::vector<RigidLoad> loads;
  const int steps = 80 * cells / 32;
  double sum = 0, squares = 0, vessels = 0;
  int count = 0;
  for (int n = 1; n <= steps; ++n) {
    EXPECT_EQ(scene.run(2. * n / steps, 1), 0);
    if (2 * n <= steps) continue;
    EXPECT_EQ(scene.solver.rigid_loads(&loads), 0);
    sum += loads[0].torque[2];
    squares += loads[0].torque[2] * loads[0].torque[2];
    vessels += loads[1].torque[2];
    ++count;
  }
  const double mean = sum / count;
  return {mean, std::sqrt(std::max(0., squares / count - mean * mean)) / std::fabs(mean), vessels / count};
}

TEST(TurningEllipse, IsOneAtRestInATurningVessel) {
  double off[2], vessel[2], scatter[2];
  for (int n = 0; n < 2; ++n) {
    const Torque turns = turning(32 << n, true, false), rests = turning(32 << n, false, false);
    off[n] = turns.mean / rests.mean - 1;
    vessel[n] = -turns.vessel / rests.mean - 1;
    scatter[n] = turns.scatter;
  }
  std::printf(
      "  ellipse turning in a vessel, 3.8 and 7.7 cells in the short half axis: torque %+.2e %+.2e off, scatter %.2e "
      "%.2e; "
      "on the vessel %+.2e %+.2e\n",
      off[0], off[1], scatter[0], scatter[1], vessel[0], vessel[1]);
  EXPECT_LT(std::fabs(off[1]), 0.01);
  EXPECT_LT(std::fabs(vessel[1]), 0.02);
  EXPECT_LT(scatter[1], 0.02);
}

// Known by its solid fraction alone, as from a file.
TEST(TurningEllipse, OfAFile) {
  const Torque shape = turning(64, true, false), file = turning(64, true, true);
  std::printf("  ellipse of a file turning, 7.7 cells in the short half axis: torque %+.2e off, on the vessel %+.2e\n",
              file.mean / shape.mean - 1, file.vessel / shape.vessel - 1);
  EXPECT_LT(std::fabs(file.mean / shape.mean - 1), 0.01);
  EXPECT_LT(std::fabs(file.vessel / shape.vessel - 1), 0.01);
  EXPECT_NE(file.mean, shape.mean);
}

}  // namespace
