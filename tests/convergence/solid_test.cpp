// Elastic solid against the exact plane shear wave S4, along every pair of directions and between walls.
#include "support/scene.hpp"

#include <gtest/gtest.h>

using namespace eulastic;
using namespace eulastic::test;

namespace {

constexpr double pi = 3.14159265358979323846;

struct Wave {
  int component, along;  // u_component varies along `along`
  bool walls;            // walls in `along`: k = pi, else periodic: k = 2 pi
  double mean;           // uniform velocity on top
};

// u = V(t) sin k x: s^2 + (mu k^2/rho) s + G k^2/rho = 0, V(0) = A, V'(0) = - mu k^2 A (B = I at the start).
double amplitude(const Wave &wave, double mu, double G, double t) {
  const double k = wave.walls ? pi : 2 * pi;
  const double decay = mu * k * k / 2, frequency = std::sqrt(G * k * k - decay * decay);
  return std::exp(-decay * t) * (std::cos(frequency * t) - decay / frequency * std::sin(frequency * t));
}

struct Result {
  std::vector<double> u;  // along the line through the origin
  double error;           // rms, of A
};

// u(0) = 1.5 sin kx, mu = 0.01, G = 1, to t = 1.
Result run_wave(const Wave &wave, int cells, int steps, const Method &method) {
  constexpr double A = 1.5, mu = 0.01, G = 1, end = 1;
  const int a = wave.component, b = wave.along;
  const double k = wave.walls ? pi : 2 * pi;
  Scene scene;
  GridSpec grid;
  grid.cells = {4, 4, a == 2 || b == 2 ? 4 : 1};
  grid.cells[b] = cells;
  if (wave.mean != 0 && a != b) grid.cells[a] = 4;
  if (wave.walls) grid.boundary[b] = Boundary::wall;
  SolverSpec spec;
  static_cast<Method &>(spec) = method;
  spec.fluid.viscosity = mu;
  EXPECT_EQ(scene.create(PETSC_COMM_SELF, grid, spec), 0);
  State &state = scene.solver.state();
  const auto shape = [=](double V, double t) {
    return [=](double x, double y, double z) {
      const double s[3] = {x, y, z};
      return V * std::sin(k * (s[b] - (wave.walls ? 0 : wave.mean * t)));
    };
  };
  set(scene.domain, state.velocity[a], at_face[a], shape(A, 0));
  if (wave.mean != 0)
    set(scene.domain, state.velocity[b], at_face[b], [&](double, double, double) { return wave.mean; });
  scene.add_phase(G, [](double, double, double) { return 1.0; });
  EXPECT_EQ(scene.solver.prepare(), 0);
  EXPECT_EQ(scene.run(end, steps), 0);
  Result result;
  for (Int3 at{}; at[b] < cells; ++at[b]) result.u.push_back(state.velocity[a](at[0], at[1], at[2]));
  result.error =
      rms_error(scene.domain, state.velocity[a], at_face[a], shape(A * amplitude(wave, mu, G, end), end)) / A;
  return result;
}

class ShearWave : public ::testing::TestWithParam<Wave> {};

TEST_P(ShearWave, SecondOrder) {  // Euler, dt = h^2
  const Method classic;
  const double e[2] = {run_wave(GetParam(), 32, 32 * 32, classic).error,
                       run_wave(GetParam(), 64, 64 * 64, classic).error};
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

// The fast method on a fixed grid against small steps, and on grids with dt in proportion to h against the exact wave.
TEST_P(ShearWave, FastIsSecondOrder) {
  Method fast = method_preset(MethodKind::fast);
  fast.pressure = PressureKind::smac;
  const std::vector<double> limit = run_wave(GetParam(), 32, 2048, fast).u;
  double time[3], space[2];
  for (int n = 0; n < 3; ++n) {
    const std::vector<double> u = run_wave(GetParam(), 32, 64 << n, fast).u;
    time[n] = 0;
    for (std::size_t i = 0; i < u.size(); ++i) time[n] += std::pow(u[i] - limit[i], 2);
    time[n] = std::sqrt(time[n] / double(u.size()));
  }
  for (int n = 0; n < 2; ++n) space[n] = run_wave(GetParam(), 32 << n, 128 << n, fast).error;
  std::printf("  S4 in time, 64, 128, 256 steps: %.3e %.3e %.3e, orders %.2f %.2f; at 32, 64: %.3e %.3e, order %.2f\n",
              time[0], time[1], time[2], order(time[0], time[1]), order(time[1], time[2]), space[0], space[1],
              order(space[0], space[1]));
  EXPECT_GT(order(time[0], time[1]), 1.9);
  EXPECT_GT(order(time[1], time[2]), 1.9);
  EXPECT_GT(order(space[0], space[1]), 1.9);
  EXPECT_LT(space[1], 4e-3);
  if (!GetParam().walls) return;
  fast.pressure = PressureKind::acm;  // which leaves other numbers in the work space than SMAC does
  EXPECT_NEAR(run_wave(GetParam(), 64, 256, fast).error, space[1], 1e-5);
}

TEST(ShearWave, AmplitudeOfReference) {  // u(0) = 1.5 sin ky: 1.23141718 at t = 1
  EXPECT_NEAR(1.5 * amplitude({0, 1, false, 0}, 0.01, 1, 1), 1.23141718, 1e-8);
}

}  // namespace
