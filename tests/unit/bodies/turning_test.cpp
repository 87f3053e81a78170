// Rigid bodies that turn through the grid, and shapes that are made of a solid fraction for it.
#include "support/rigid_scene.hpp"

#include <gtest/gtest.h>

using namespace eulastic;
using namespace eulastic::test;

namespace {

// An ellipsoid that turns about a line through its centre: where its surface is follows from the time alone, and its
// moments are those of the turned ellipsoid.
TEST(TurningBodies, PlaceIsAFunctionOfTime) {
  Scene scene;
  GridSpec spec;
  spec.cells = {20, 18, 16};
  spec.length = {2, 1.8, 1.6};
  SolverSpec solver;
  static_cast<Method &>(solver) = method_preset(MethodKind::fast);
  ASSERT_EQ(scene.create(PETSC_COMM_SELF, spec, solver), 0);
  SpeciesSpec body = rigid_body(Shape::ellipsoid, 0, {1.03, 0.87, 0.81});
  body.law = Law::rigid;
  body.semi_axes = {0.6, 0.3, 0.45};
  body.motion.angular_velocity = {0.6, -0.8, 1.1};
  body.motion.of_rotation = {2, 0.5};
  Phase phase;
  ASSERT_EQ(fill_phase(scene.domain, body, {{body.centre, {}}}, 1, &phase), 0);
  RigidBodies bodies(scene.domain, scene.solver.exchange());
  std::string wrong;
  ASSERT_EQ(bodies.add(body, {{body.centre, {10, 20, 30}}}, 1, &phase, &wrong), 0);
  ASSERT_TRUE(bodies.travel());
  const double time = 0.7, gone = (std::sin(2 * time + 0.5) - std::sin(0.5)) / 2;
  ASSERT_EQ(bodies.find_faces(0.3, 0.2), 0);
  ASSERT_EQ(bodies.find_faces(time, time), 0);
  // The rotation, composed independently: v turned about w by Rodrigues' formula.
  const auto turn = [&](Real3 v) {
    const Real3 &w = body.motion.angular_velocity;
    const double size = std::sqrt(w[0] * w[0] + w[1] * w[1] + w[2] * w[2]), angle = size * gone;
    Real3 result{};
    double along = 0;
    for (int d = 0; d < 3; ++d) along += w[d] / size * v[d];
    for (int d = 0; d < 3; ++d) {
      const int e = (d + 1) % 3, f = (d + 2) % 3;
      result[d] = v[d] * std::cos(angle) + (w[e] * v[f] - w[f] * v[e]) / size * std::sin(angle) +
                  w[d] / size * along * (1 - std::cos(angle));
    }
    return result;
  };
  const Rotation start = rotation({10, 20, 30});
  std::array<Real3, 3> axes;
  for (int m = 0; m < 3; ++m) axes[m] = turn({start[0][m], start[1][m], start[2][m]});
  const auto level = [&](const Real3 &x) {
    double square = 0;
    for (int m = 0; m < 3; ++m) {
      double along = 0;
      for (int d = 0; d < 3; ++d) along += axes[m][d] * (x[d] - body.centre[d]);
      square += std::pow(along / body.semi_axes[m], 2);
    }
    return std::sqrt(square) - 1;
  };
  const Domain &domain = scene.domain;
  int links = 0;
  for (int a = 0; a < 3; ++a)
    for (int k = 0; k < domain.cells()[2]; ++k)
      for (int j = 0; j < domain.cells()[1]; ++j) {
        const RigidFaces::Row row = bodies.faces().row(a, j, k);
        const auto place = [&](int i) {
          return Real3{position(domain, 0, a == 0, i), position(domain, 1, a == 1, j), position(domain, 2, a == 2, k)};
        };
        for (const RigidFaces::Run &run : row.runs)
          for (int i = std::max(run.begin, 0); i < std::min(run.end, domain.cells()[0]); ++i)
            EXPECT_LT(level(place(i)), 0);
        for (const RigidFaces::Cut &cut : row.cuts)
          for (int link = 0; link < 6; ++link) {
            if (!(cut.walls >> link & 1U) || cut.i < 0 || cut.i >= domain.cells()[0]) continue;
            const int d = link / 2;
            Real3 end = place(cut.i);
            end[d] += (link % 2 ? 1 : -1) / (cut.link[link] * domain.spacing()[d]);
            EXPECT_NEAR(level(end), 0, 4e-4);  // no link is shorter than a thousandth of a cell
            ++links;
          }
      }
  EXPECT_GT(links, 300);
  const RigidMass &mass = bodies.faces().masses[0];
  const double volume = 4 * M_PI / 3 * 0.6 * 0.3 * 0.45;
  EXPECT_NEAR(mass.volume, volume, 1e-5 * volume);
  double xx = 0, xy = 0;
  for (int m = 0; m < 3; ++m) {
    xx += volume / 5 * std::pow(body.semi_axes[m], 2) * axes[m][0] * axes[m][0];
    xy += volume / 5 * std::pow(body.semi_axes[m], 2) * axes[m][0] * axes[m][1];
  }
  EXPECT_NEAR(mass.second[0], xx, 1e-3 * xx);
  EXPECT_NEAR(mass.second[5], xy, 1e-3 * xx);
  for (int d = 0; d < 3; ++d) EXPECT_NEAR(mass.first[d], 0, 1e-8);
}

// Force and torque that the motion of a body takes: the rates of change of its momentum and angular momentum.
TEST(TurningBodies, MassAccelerates) {
  RigidMotion motion;
  motion.turning = true;
  motion.angular_velocity = {0.4, -0.7, 0.9};
  motion.velocity = {1, 0.5, -0.2};
  motion.travelling = {true, true, true};
  motion.of_velocity = {1.3, 0.2};
  const std::vector<Real3> points{{0.3, 0.1, -0.2}, {-0.4, 0.5, 0.1}, {0.2, -0.3, 0.6}};
  RigidMass mass;
  Real3 force{}, torque{};
  const double time = 0.8, density = 2;
  for (const Real3 &r : points) {
    mass.volume += 1;
    const Real3 a = motion.acceleration(r, time);
    for (int d = 0; d < 3; ++d) {
      const int e = (d + 1) % 3, f = (d + 2) % 3;
      mass.first[d] += r[d];
      mass.second[d] += r[d] * r[d];
      mass.second[3 + d] += r[e] * r[f];
      force[d] += density * a[d];
      torque[d] += density * (r[e] * a[f] - r[f] * a[e]);
    }
  }
  const Real3 F = mass.force(motion, time, density), T = mass.torque(motion, time, density);
  for (int d = 0; d < 3; ++d) {
    EXPECT_NEAR(F[d], force[d], 1e-12);
    EXPECT_NEAR(T[d], torque[d], 1e-12);
  }
  // Of a point that goes with the body: its acceleration is the change of its velocity.
  const double step = 1e-4;
  const auto velocity_at = [&](double t) {
    Real3 r{0.3, 0.1, -0.2};
    const Real3 v = motion.frame_velocity(r, time), of_centre = motion.frame_velocity({}, time);
    for (int d = 0; d < 3; ++d) r[d] += (v[d] - of_centre[d]) * (t - time);
    return motion.frame_velocity(r, t);
  };
  const Real3 before = velocity_at(time - step), after = velocity_at(time + step),
              a = motion.acceleration({0.3, 0.1, -0.2}, time);
  for (int d = 0; d < 3; ++d) EXPECT_NEAR((after[d] - before[d]) / (2 * step), a[d], 1e-6);
}

// The surface that is made of the solid fraction of a disc.
TEST(LevelMaps, AreZeroOnTheSurface) {
  GridSpec grid;
  grid.cells = {40, 40, 1};
  grid.length = {4, 4, 1};
  SpeciesSpec disc = rigid_body(Shape::sphere, 0.83, {2.03, 1.98, 0.5});
  const Surface exact(disc, 2);
  const PlacedBody body(exact, grid, {disc.centre, {}});
  FractionBox box;
  box.size = {40, 40, 1};
  box.spacing = {0.1, 0.1, 0};
  box.first = {0.05 - 2.03, 0.05 - 1.98, 0};
  for (int j = 0; j < 40; ++j)
    for (int i = 0; i < 40; ++i) box.fraction.push_back(body.fraction({i, j, 0}));
  const LevelMap map(box, 2);
  for (int n = 0; n < 200; ++n) {
    const Real3 way{std::cos(0.0314 * n), std::sin(0.0314 * n), 0};
    double low = 0.5, high = 1.2;
    while (high - low > 1e-9) {
      const double middle = 0.5 * (low + high);
      (map.level({middle * way[0], middle * way[1], 0}) < 0 ? low : high) = middle;
    }
    EXPECT_NEAR(low, 0.83, 0.004);  // cells of .1
    EXPECT_GE(map.support(way), 0.83);
    EXPECT_LT(map.support(way), 1.03);
  }
  EXPECT_GE(map.bounding_radius(), 0.83);
  EXPECT_NEAR(moments(Surface(map), 2).volume, M_PI * 0.83 * 0.83, 0.01);
}

}  // namespace
