// Elastic solid against the exact plane shear wave S4, along every pair of directions and between walls.
#include "support/scene.hpp"

#include <gtest/gtest.h>

using namespace eulastic;
using namespace eulastic::test;

namespace {

constexpr double pi = 3.14159265358979323846;

struct Wave {
  int component, along;   // u_component varies along `along`
  bool walls;             // walls in `along`: k = pi, else periodic: k = 2 pi
  double mean;            // uniform velocity on top
};

// u = V(t) sin k x: s^2 + (mu k^2/rho) s + G k^2/rho = 0, V(0) = A, V'(0) = - mu k^2 A (B = I at the start).
double amplitude(const Wave &wave, double mu, double G, double t) {
  const double k = wave.walls ? pi : 2 * pi;
  const double decay = mu * k * k / 2, frequency = std::sqrt(G * k * k - decay * decay);
  return std::exp(-decay * t) * (std::cos(frequency * t) - decay / frequency * std::sin(frequency * t));
}

double wave_error(const Wave &wave, int cells, double A, double mu, double G, double end) {
  const int a = wave.component, b = wave.along;
  const double k = wave.walls ? pi : 2 * pi;
  Scene scene;
  GridSpec grid;
  grid.cells = {4, 4, a == 2 || b == 2 ? 4 : 1};
  grid.cells[b] = cells;
  if (wave.mean != 0 && a != b) grid.cells[a] = 4;
  if (wave.walls) grid.boundary[b] = Boundary::wall;
  SolverSpec spec;
  spec.fluid.viscosity = mu;
  EXPECT_EQ(scene.create(PETSC_COMM_SELF, grid, spec), 0);
  State &state = scene.solver.state();
  const auto shape = [=](double V, double t) {
    return [=](double x, double y, double z) {
      const double s[3] = {x, y, z};
      return V * std::sin(k * (s[b] - (wave.walls ? 0 : wave.mean * t)));
    };
  };
  set(scene.grid, state.velocity[a], at_face[a], shape(A, 0));
  if (wave.mean != 0) set(scene.grid, state.velocity[b], at_face[b], [&](double, double, double) { return wave.mean; });
  scene.add_phase(G, [](double, double, double) { return 1.0; });
  EXPECT_EQ(scene.solver.prepare(), 0);
  EXPECT_EQ(scene.run(end, cells * cells * 4), 0);
  return rms_error(scene.grid, state.velocity[a], at_face[a], shape(A * amplitude(wave, mu, G, end), end)) / A;
}

class ShearWave : public ::testing::TestWithParam<Wave> {};

TEST_P(ShearWave, SecondOrder) {
  const double e[2] = {wave_error(GetParam(), 32, 1.5, 0.01, 1, 1), wave_error(GetParam(), 64, 1.5, 0.01, 1, 1)};
  std::printf("  S4 at 32, 64: %.3e %.3e, order %.2f\n", e[0], e[1], order(e[0], e[1]));
  EXPECT_GT(order(e[0], e[1]), 1.9);
  EXPECT_LT(e[1], GetParam().mean != 0 ? 2e-2 : 8e-3);
}

INSTANTIATE_TEST_SUITE_P(Directions, ShearWave,
                         ::testing::Values(Wave{0, 1, false, 0}, Wave{1, 0, false, 0}, Wave{2, 0, false, 0},
                                           Wave{2, 1, false, 0}, Wave{0, 2, false, 0}, Wave{1, 2, false, 0},
                                           Wave{0, 1, true, 0}, Wave{1, 0, true, 0}, Wave{1, 2, true, 0},
                                           Wave{0, 1, false, 0.5}, Wave{1, 2, false, 0.5}),
                         [](const auto &test) {
                           const Wave &w = test.param;
                           return std::string(1, "uvw"[w.component]) + "_along_" + "xyz"[w.along] +
                                  (w.walls ? "_walls" : "") + (w.mean != 0 ? "_moving" : "");
                         });

TEST(ShearWave, AmplitudeOfReference) {  // u(0) = 1.5 sin ky: 1.23141718 at t = 1
  EXPECT_NEAR(1.5 * amplitude({0, 1, false, 0}, 0.01, 1, 1), 1.23141718, 1e-8);
}

}  // namespace
