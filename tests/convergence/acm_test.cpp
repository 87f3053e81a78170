// ACM against the exact projection: the velocities differ by O(dt^2) at a fixed time on a fixed grid.
#include "support/scene.hpp"

#include <gtest/gtest.h>

using namespace eulastic;
using namespace eulastic::test;

namespace {

constexpr double pi = 3.14159265358979323846;

// rms difference of v, ACM - SMAC, relative to the rms of v, after `steps` steps to a fixed time.
template <class Start>
double difference(const GridSpec &grid, SolverSpec spec, double end, int steps, Start start) {
  Scene scene[2];
  for (const PressureKind kind : {PressureKind::acm, PressureKind::smac}) {
    Scene &s = scene[kind == PressureKind::smac];
    spec.pressure = kind;
    EXPECT_EQ(s.create(PETSC_COMM_SELF, grid, spec), 0);
    start(s);
    EXPECT_EQ(s.solver.prepare(), 0);
    EXPECT_EQ(s.run(end, steps), 0);
  }
  double sum = 0, reference = 0;
  for (int a = 0; a < scene[0].domain.dimension(); ++a)
    for (int k = 0; k < grid.cells[2]; ++k)
      for (int j = 0; j < grid.cells[1]; ++j)
        for (int i = 0; i < grid.cells[0]; ++i) {
          const double acm = scene[0].solver.state().velocity[a](i, j, k);
          const double smac = scene[1].solver.state().velocity[a](i, j, k);
          sum += (acm - smac) * (acm - smac);
          reference += smac * smac;
        }
  return std::sqrt(sum / reference);
}

template <class Difference>
void expect_second_order(const char *name, int steps, double largest, Difference difference_at) {
  double e[4];
  for (int r = 0; r < 4; ++r) e[r] = difference_at(steps << r);
  std::printf("  %s ACM - SMAC: %.3e %.3e %.3e %.3e, orders %.2f %.2f %.2f\n", name, e[0], e[1], e[2], e[3],
              order(e[0], e[1]), order(e[1], e[2]), order(e[2], e[3]));
  EXPECT_GT(order(e[1], e[2]), 1.8);
  EXPECT_GT(order(e[2], e[3]), 1.8);
  EXPECT_LT(e[3], largest);
}

TEST(AcmAgainstSmac, TaylorGreenCarriedAlong) {
  GridSpec grid;
  grid.cells = {32, 32, 1};
  SolverSpec spec;
  spec.fluid.viscosity = 0.01;
  const double k = 2 * pi;
  const auto start = [=](Scene &s) {
    State &state = s.solver.state();
    set(s.domain, state.velocity[0], at_face[0],
        [=](double x, double y, double) { return 1 + std::sin(k * x) * std::cos(k * y); });
    set(s.domain, state.velocity[1], at_face[1],
        [=](double x, double y, double) { return 1 - std::cos(k * x) * std::sin(k * y); });
    set(s.domain, state.pressure[0], at_centre,
        [=](double x, double y, double) { return 0.25 * (std::cos(2 * k * x) + std::cos(2 * k * y)); });
  };
  expect_second_order("Taylor-Green", 100, 1e-4, [&](int steps) { return difference(grid, spec, 0.25, steps, start); });
}

TEST(AcmAgainstSmac, DiscInAChannel) {
  GridSpec grid;
  grid.cells = {32, 32, 1};
  grid.length = {21.12, 21.12, 21.12};
  grid.boundary[1] = Boundary::wall;
  SolverSpec spec;
  spec.fluid.body_force.force = {2e-4, 0, 0};
  const auto start = [](Scene &s) {
    s.add_phase(0.02, [](double x, double y, double) {
      return 0.5 - 0.5 * std::tanh((std::hypot(x - 10.56, y - 8) - 4) / 0.7);
    });
  };
  expect_second_order("disc", 200, 1e-5, [&](int steps) { return difference(grid, spec, 10, steps, start); });
}

}  // namespace
