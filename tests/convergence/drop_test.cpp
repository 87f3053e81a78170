// A drop of surface tension that is let go, in two dimensions: the rate, its order, and what flows at rest.
#include "solver/synchronised_state.hpp"
#include "support/interface_scene.hpp"
#include "support/scene.hpp"

#include <gtest/gtest.h>

using namespace eulastic;
using namespace eulastic::test;

namespace {

constexpr double side = 4;  // of the periodic box, in radii

// phi (x^2 - y^2) over the box, of the ellipse (1 + e) x 1/(1 + e): 0 for a disc.
double elongation(const Scene &scene, const Phase &phase) {
  double sum = 0;
  for_points(scene.domain, ConstView(phase.fraction[0]), at_centre, [&](const double &q, double x, double y, double) {
    sum += q * ((x - side / 2) * (x - side / 2) - (y - side / 2) * (y - side / 2));
  });
  return sum * scene.domain.cell_volume();
}

struct Run {
  double left = 0;   // elongation at t = 2 mu R/sigma over that at .5
  double speed = 0;  // largest mu u/sigma at t = 2
};

// `ratio`: viscosity of the drop; `finer`: steps of .25 h mu/sigma are divided by that.
Run let_go(int cells, double stretch, double ratio = 1, int finer = 1) {
  Scene scene;
  GridSpec grid;
  grid.cells = {cells, cells, 1};
  grid.length = {side, side, 1};
  SolverSpec spec;
  static_cast<Method &>(spec) = method_preset(MethodKind::fast);
  spec.pressure = PressureKind::smac;
  spec.fluid.density = 1e-3;
  spec.fluid.viscosity = 1;
  EXPECT_EQ(scene.create(PETSC_COMM_SELF, grid, spec), 0);
  const double h = side / cells, a = stretch, cx = side / 2 + 0.3 * h, cy = side / 2 + 0.1 * h;
  const Position ellipse = [=](const Real3 &x) {
    const double u = (x[0] - cx) / a, v = (x[1] - cy) * a, level = std::hypot(u, v);
    return level > 0 ? (level - 1) * level / std::hypot(u / a, v * a) : -1.0;
  };
  Material &drop =
      scene.add_phase(0,
                      [&](double x, double y, double z) {
                        return cell_fraction(ellipse, {x, y, z}, {h, h, 1}, 2);
                      })
          .material;
  drop.surface_tension = 1;
  if (ratio != 1) drop.viscosity = ratio;
  EXPECT_EQ(scene.solver.prepare(), 0);
  const int steps = cells / 4 * finer;  // of .25 h mu/sigma in unit time
  Run run;
  const std::vector<Phase> *phases = nullptr;
  EXPECT_EQ(scene.run(0.5, steps * 2), 0);
  EXPECT_EQ(scene.solver.synchronised().phases(&phases), 0);
  const double first = elongation(scene, (*phases)[0]);
  EXPECT_EQ(scene.run(2, steps * 6), 0);
  EXPECT_EQ(scene.solver.synchronised().phases(&phases), 0);
  run.left = elongation(scene, (*phases)[0]) / first;
  FlowExtremes extremes;
  EXPECT_EQ(scene.solver.measure(&extremes), 0);
  run.speed = extremes.max_speed();
  return run;
}

TEST(Drop, RelaxesAtTheRateOfStokesFlow) {
  double rate[3];
  for (int n = 0; n < 3; ++n) rate[n] = -std::log(let_go(32 << n, 1.05).left) / 1.5;
  const double exact = 0.3264;  // of Stokes flow in this box, by Fourier transforms; unbounded .5
  std::printf("  rate of the ellipse 1.05, 8, 16, 32 cells per radius: %.5f %.5f %.5f, for h -> 0 %.4f\n", rate[0],
              rate[1], rate[2], exact);
  EXPECT_NEAR(rate[2], exact, 0.004 * exact);
  EXPECT_LT(std::fabs(rate[2] - exact), std::fabs(rate[0] - exact));
}

// The pressure of such a drop takes more than one step to follow; what it lags behind must not count, at almost no
// inertia least of all. The automatic step is .4 of h and the mean viscosity over sigma: .24, 1.2 and 4.2 for the
// three.
TEST(Drop, ViscosityContrastLeavesTheTimeStepItsOrder) {
  for (const double ratio : {0.2, 5., 20.}) {
    const double coarse = -std::log(let_go(32, 1.05, ratio).left), fine = -std::log(let_go(32, 1.05, ratio, 4).left);
    std::printf("  viscosity %g of the fluid's: decay with steps of .25 h mu/sigma over that with a quarter %.4f\n",
                ratio, coarse / fine);
    EXPECT_NEAR(coarse / fine, 1, 0.01);
  }
}

TEST(Drop, HardlyFlowsAtRest) {
  double speed[3];
  for (int n = 0; n < 3; ++n) speed[n] = let_go(32 << n, 1).speed;
  std::printf("  largest mu u/sigma at rest, t = 2, 8, 16, 32 cells per radius: %.1e %.1e %.1e\n", speed[0], speed[1],
              speed[2]);
  EXPECT_LT(speed[1], 1e-4);
  EXPECT_LT(speed[2], speed[0] / 4);
}

}  // namespace
