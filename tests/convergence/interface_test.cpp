// Shapes carried once around: the centroid at second order, the shape at first (the tanh is 2-3 cells wide for ever).
#include "support/interface_scene.hpp"

#include <gtest/gtest.h>

using namespace eulastic;
using namespace eulastic::test;

namespace {

constexpr double pi = 3.14159265358979323846;

struct Errors {
  double shape, centroid, volume, width;  // width: integral of 4 phi (1 - phi) per area of the interface, in cells
};

double order(double coarse, double fine) { return std::log2(coarse / fine); }

// `steps` of dt * factor(time of the middle of the step).
Errors carry(
    InterfaceScene &scene, const Position &level, double end, int steps,
    const std::function<double(double)> &factor = [](double) { return 1.0; }) {
  scene.set_fraction(level);
  const Real3 start = scene.centroid();
  const double volume = scene.sum(), dt = end / steps;
  for (int n = 0; n < steps; ++n) EXPECT_EQ(scene.advance(dt * factor((n + 0.5) * dt)), 0);
  Errors errors{scene.shape_error(level), 0, std::abs(scene.sum() / volume - 1), 0};
  const Real3 centre = scene.centroid();
  for (int d = 0; d < scene.grid.dimension(); ++d)
    errors.centroid = std::max(errors.centroid, std::abs(centre[d] - start[d]));
  errors.width = scene.sum([](double q) { return 4 * q * (1 - q); });
  EXPECT_LT(errors.volume, 1e-13);
  EXPECT_EQ(scene.sum([](double q) { return !(q >= 0 && q <= 1); }), 0);
  return errors;
}

GridSpec unit_box(int cells, int dimension, Boundary boundary) {
  GridSpec spec;
  spec.cells = {cells, cells, dimension == 2 ? 1 : cells};
  spec.boundary = {boundary, boundary, boundary};
  return spec;
}

void print(const char *name, int cells, const Errors &e) {
  std::printf("  %s, N = %d: shape %.3e, centroid %.3e, volume %.0e\n", name, cells, e.shape, e.centroid, e.volume);
}

Errors translate(int cells, int dimension, const Real3 &velocity, double courant) {
  InterfaceScene scene;
  EXPECT_EQ(scene.create(PETSC_COMM_SELF, unit_box(cells, dimension, Boundary::periodic)), 0);
  scene.set_velocity(velocity);
  const double radius = 0.2;
  Errors e = carry(scene, ball({0.5, 0.5, 0.5}, radius, dimension), 1, static_cast<int>(std::lround(cells / courant)));
  e.width /= dimension == 2 ? 2 * pi * radius * cells : 4 * pi * radius * radius * cells * cells;
  print("translated", cells, e);
  return e;
}

// Literature: about 1 for the shape, as the profile itself is as wide as in the first step. 4 phi (1 - phi) of a tanh
// of steepness 2.3 has the integral 2/2.3.
void expect_orders(const Errors (&e)[3], double centroid_order, double finest_shape) {
  std::printf("  orders: shape %.2f, centroid %.2f\n", order(e[1].shape, e[2].shape),
              order(e[1].centroid, e[2].centroid));
  EXPECT_GT(order(e[0].shape, e[2].shape) / 2, 0.75);
  EXPECT_LT(e[2].shape, finest_shape);
  EXPECT_GT(order(e[0].centroid, e[2].centroid) / 2, centroid_order);
  for (const Errors &each : e) {
    EXPECT_GT(each.width, 0.5);
    EXPECT_LT(each.width, 1.2);
  }
}

TEST(InterfaceTranslation, DiscAlongTheDiagonal) {
  expect_orders({translate(32, 2, {1, 1, 0}, .25), translate(64, 2, {1, 1, 0}, .25), translate(128, 2, {1, 1, 0}, .25)},
                1.8, 0.022);
}

TEST(InterfaceTranslation, DiscAlongAnAxisInSmallSteps) {
  expect_orders({translate(32, 2, {0, 1, 0}, .05), translate(64, 2, {0, 1, 0}, .05), translate(128, 2, {0, 1, 0}, .05)},
                1.8, 0.011);
}

TEST(InterfaceTranslation, SphereAlongTheDiagonal) {
  expect_orders({translate(16, 3, {1, 1, 1}, .15), translate(32, 3, {1, 1, 1}, .15), translate(64, 3, {1, 1, 1}, .15)},
                1.8, 0.07);
}

// 10^4 steps: the volume is kept to round-off, without a drift.
TEST(InterfaceTranslation, KeepsTheVolumeInTenThousandSteps) {
  InterfaceScene scene;
  ASSERT_EQ(scene.create(PETSC_COMM_SELF, unit_box(32, 2, Boundary::periodic)), 0);
  scene.set_velocity(Real3{0.5, -0.25, 0});
  const Errors e = carry(scene, ball({0.5, 0.5, 0}, 0.25, 2), 60, 10000);
  print("10^4 steps", 32, e);
}

// A disc with a slot (Zalesak, JCP 31, 1979), once around the centre of the box.
Errors rotate(int cells, bool slotted) {
  InterfaceScene scene;
  EXPECT_EQ(scene.create(PETSC_COMM_SELF, unit_box(cells, 2, Boundary::periodic)), 0);
  const auto stream = [](const Real3 &x) {  // solid rotation inside 0.45, at rest outside
    const double r = std::min(std::hypot(x[0] - 0.5, x[1] - 0.5), 0.45);
    return -r * r / 2;
  };
  EXPECT_EQ(scene.set_velocity(Potential{nullptr, nullptr, stream}), 0);
  const Position disc = ball({0.5, 0.75, 0}, 0.15, 2);
  const Position slot = [=](const Real3 &x) {
    return std::max(disc(x), std::min(0.025 - std::abs(x[0] - 0.5), 0.85 - x[1]));
  };
  const Errors e = carry(scene, slotted ? slot : disc, 2 * pi, static_cast<int>(std::lround(4 * pi * cells)));
  print(slotted ? "Zalesak" : "rotated", cells, e);
  return e;
}

TEST(InterfaceRotation, Disc) {
  const Errors coarse = rotate(64, false), fine = rotate(128, false);
  EXPECT_LT(fine.shape, 0.018);
  EXPECT_GT(order(coarse.shape, fine.shape), 0.7);
  EXPECT_GT(order(coarse.centroid, fine.centroid), 1.7);
}

// At 64 the slot is three cells wide.
TEST(InterfaceRotation, ZalesaksDisc) {
  const Errors coarse = rotate(64, true), fine = rotate(128, true);
  EXPECT_LT(fine.shape, 0.045);
  EXPECT_GT(order(coarse.shape, fine.shape), 0.9);
}

// Single vortex (Rider & Kothe, JCP 141, 1998), there and back in time T.
Errors shear(int cells, double T) {
  InterfaceScene scene;
  EXPECT_EQ(scene.create(PETSC_COMM_SELF, unit_box(cells, 2, Boundary::wall)), 0);
  const auto stream = [](const Real3 &x) { return std::pow(std::sin(pi * x[0]) * std::sin(pi * x[1]), 2) / pi; };
  EXPECT_EQ(scene.set_velocity(Potential{nullptr, nullptr, stream}), 0);
  const Errors e = carry(scene, ball({0.5, 0.75, 0}, 0.15, 2), T, static_cast<int>(std::lround(4 * T * cells)),
                         [=](double t) { return std::cos(pi * t / T); });
  print(T < 5 ? "vortex, T = 2" : "vortex, T = 8", cells, e);
  return e;
}

TEST(InterfaceVortex, ThereAndBack) {
  const Errors e[3] = {shear(32, 2), shear(64, 2), shear(128, 2)};
  std::printf("  order of the shape %.2f\n", order(e[0].shape, e[2].shape) / 2);
  EXPECT_GT(order(e[0].shape, e[2].shape) / 2, 1);
  EXPECT_LT(e[2].shape, 0.018);
  EXPECT_LT(e[2].centroid, 1e-4);
}

// Drawn out to a spiral of one or two cells: what breaks off depends on N alone.
TEST(InterfaceVortex, SpiralAndBack) {
  const Errors coarse = shear(64, 8), fine = shear(128, 8);
  EXPECT_LT(fine.shape, 0.07);
  EXPECT_GT(order(coarse.shape, fine.shape), 1.5);
}

// LeVeque's deformation of a sphere (SIAM J. Numer. Anal. 33, 1996), T = 1.
Errors deform(int cells) {
  InterfaceScene scene;
  EXPECT_EQ(scene.create(PETSC_COMM_SELF, unit_box(cells, 3, Boundary::wall)), 0);
  const auto s = [](double x) { return std::sin(pi * x); };
  const auto s2 = [](double x) { return std::sin(2 * pi * x); };
  EXPECT_EQ(scene.set_velocity(
                Potential{nullptr, [=](const Real3 &x) { return -std::pow(s(x[0]) * s(x[2]), 2) * s2(x[1]) / pi; },
                          [=](const Real3 &x) { return std::pow(s(x[0]) * s(x[1]), 2) * s2(x[2]) / pi; }}),
            0);
  const Errors e =
      carry(scene, ball({0.35, 0.35, 0.35}, 0.15, 3), 1, 10 * cells, [](double t) { return std::cos(pi * t); });
  print("deformed", cells, e);
  return e;
}

TEST(InterfaceDeformation, ThereAndBack) {
  const Errors coarse = deform(24), fine = deform(48);
  EXPECT_GT(order(coarse.shape, fine.shape), 1);
  EXPECT_GT(order(coarse.centroid, fine.centroid), 1.5);
}

}  // namespace
