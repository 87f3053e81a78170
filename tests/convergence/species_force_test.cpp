// A force on the bodies of one species: a layer of marked fluid below s drives the channel; exact, steady,
// u = f (s - s^2/2) y/nu - f y^2/(2 nu) in it, f s^2 (1 - y)/(2 nu) above.
#include "solids/species_force.hpp"
#include "support/scene.hpp"

#include <gtest/gtest.h>

using namespace eulastic;
using namespace eulastic::test;

namespace {

constexpr double nu = 0.5, f = 0.8, s = 0.43;

double exact(double y) { return y < s ? f * ((s - s * s / 2) * y - y * y / 2) / nu : f * s * s * (1 - y) / (2 * nu); }

double error(int cells, MethodKind method) {
  Scene scene;
  GridSpec grid;
  grid.cells = {4, cells, 1};
  grid.length = {4. / cells, 1, 1};
  grid.boundary[1] = Boundary::wall;
  SolverSpec spec;
  static_cast<Method &>(spec) = method_preset(method);
  spec.fluid.viscosity = nu;
  EXPECT_EQ(scene.create(PETSC_COMM_SELF, grid, spec), 0);
  Phase &layer =
      scene.add_phase(0, [&](double, double y, double) { return std::min(1.0, std::max(0.0, (s - y) * cells + 0.5)); });
  layer.material.body_force.force = {f, 0, 0};
  EXPECT_EQ(scene.solver.prepare(), 0);
  EXPECT_EQ(scene.run(3, method == MethodKind::fast ? 300 : 12 * cells * cells), 0);
  double power = 0;
  const State &state = scene.solver.state();
  EXPECT_EQ(scene.solver.force_power(&power), 0);
  const double given = f * f / nu * ((s - s * s / 2) * s * s / 2 - s * s * s / 6) * grid.length[0];
  EXPECT_NEAR(power, given, 0.02 * given);
  return rms_error(scene.domain, state.velocity[0], at_face[0], [](double, double y, double) { return exact(y); });
}

TEST(SpeciesForce, DrivesItsLayer) {
  for (const MethodKind method : {MethodKind::fast, MethodKind::classic}) {
    const double coarse = error(16, method), fine = error(32, method);
    std::printf("  layer with a force of its own, %s: %.2e %.2e, order %.2f\n",
                method == MethodKind::fast ? "fast" : "classic", coarse, fine, order(coarse, fine));
    EXPECT_LT(fine, 2e-4);
    EXPECT_GT(order(coarse, fine), 1.5);
  }
}

}  // namespace
