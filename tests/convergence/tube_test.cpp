// Steady flow in a tube with an elastic wall: Poiseuille's u = g (R^2 - r^2)/(4 nu) in the lumen, 0 in the wall.
#include "bodies/fill_phase.hpp"
#include "support/scene.hpp"

#include <gtest/gtest.h>

using namespace eulastic;
using namespace eulastic::test;

namespace {

struct Errors {
  double velocity;  // rms over the lumen, in parts of the exact largest
  double flow_rate;
};

Errors tube(int cells) {
  const double nu = 0.1, g = 0.5, radius = 0.4;
  Scene scene;
  GridSpec grid;
  grid.cells = {4, cells, cells};
  grid.length = {4. / cells, 1, 1};
  grid.boundary[1] = grid.boundary[2] = Boundary::wall;
  SolverSpec spec;
  static_cast<Method &>(spec) = method_preset(MethodKind::fast);
  spec.fluid.viscosity = nu;
  spec.fluid.body_force.force = {g, 0, 0};
  EXPECT_EQ(scene.create(PETSC_COMM_SELF, grid, spec), 0);
  SpeciesSpec vessel;
  vessel.shape = Shape::tube;
  vessel.axis = 0;
  vessel.radius = radius;
  vessel.shear_modulus = 1;
  vessel.centre = {0, 0.5, 0.5};
  Phase phase;
  EXPECT_EQ(fill_phase(scene.domain, vessel, {{vessel.centre, {}}}, 1, &phase), 0);
  scene.solver.state().phases.push_back(std::move(phase));
  EXPECT_EQ(scene.solver.prepare(), 0);
  EXPECT_EQ(scene.run(3, 18 * cells), 0);  // exp(-5.78 nu t/R^2) = 2e-5 of the start is left
  const double largest = g * radius * radius / (4 * nu);
  double square = 0, points = 0, flow = 0;
  for_points(scene.domain, scene.solver.state().velocity[0], at_face[0],
             [&](const double &u, double, double y, double z) {
               const double r2 = (y - 0.5) * (y - 0.5) + (z - 0.5) * (z - 0.5), s = 1 - r2 / (radius * radius);
               flow += u;
               if (s < 0) return;
               square += (u / largest - s) * (u / largest - s);
               points += 1;
             });
  flow /= 4.0 * cells * cells;
  return {std::sqrt(square / points), flow / (0.5 * M_PI * radius * radius * largest) - 1};
}

// The surface lies anywhere in its cells, so errors scatter. Orders of u between N and 2 N cells: 1.85 (N = 20),
// 2.09 (24), 1.91 (28), 2.04 (32).
TEST(Tube, PlasmaFlowsAsPoiseuilleSays) {
  const Errors coarse = tube(24), fine = tube(48);
  std::printf("  tube of 19.2, 38.4 cells across: u %.3e %.3e, order %.2f; flow rate %+.3e %+.3e, order %.2f\n",
              coarse.velocity, fine.velocity, order(coarse.velocity, fine.velocity), coarse.flow_rate, fine.flow_rate,
              order(std::fabs(coarse.flow_rate), std::fabs(fine.flow_rate)));
  EXPECT_GT(order(coarse.velocity, fine.velocity), 1.8);
  EXPECT_LT(fine.velocity, 3.5e-3);
  EXPECT_LT(std::fabs(fine.flow_rate), 4e-3);
}

}  // namespace
