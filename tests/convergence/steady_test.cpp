// Steady flows of the fast method: F6, the lid-driven cavity at Re = 100, and S3, a solid layer under a driven fluid.
#include "support/materials.hpp"
#include "support/scene.hpp"

#include <gtest/gtest.h>

using namespace eulastic;
using namespace eulastic::test;

namespace {

SolverSpec fast_spec(double viscosity) {
  SolverSpec spec;
  static_cast<Method &>(spec) = method_preset(MethodKind::fast);
  spec.fluid.viscosity = viscosity;
  return spec;
}

// Least value of a sampled curve: the vertex of the parabola through the lowest sample and its neighbours.
double lowest(const std::vector<double> &q) {
  std::size_t m = 1;
  for (std::size_t i = 1; i + 1 < q.size(); ++i)
    if (q[i] < q[m]) m = i;
  const double slope = 0.5 * (q[m + 1] - q[m - 1]), curvature = q[m + 1] - 2 * q[m] + q[m - 1];
  return q[m] - 0.5 * slope * slope / curvature;
}

// Least u on x = 1/2 and least v on y = 1/2.
std::array<double, 2> cavity(int cells) {
  Scene scene;
  GridSpec grid;
  grid.cells = {cells, cells, 1};
  grid.boundary[0] = grid.boundary[1] = Boundary::wall;
  SolverSpec spec = fast_spec(0.01);
  spec.sides[1][1].motion.velocity = {1, 0, 0};
  EXPECT_EQ(scene.create(PETSC_COMM_SELF, grid, spec), 0);
  EXPECT_EQ(scene.solver.prepare(), 0);
  EXPECT_EQ(scene.run(30, 100 * cells), 0);  // Courant number .3 of the lid
  const State &state = scene.solver.state();
  std::vector<double> u, v;
  for (int n = 0; n < cells; ++n) {
    u.push_back(state.velocity[0](cells / 2, n, 0));
    v.push_back(state.velocity[1](n, cells / 2, 0));
  }
  return {lowest(u), lowest(v)};
}

TEST(Cavity, ConvergesToTheReference) {  // Newton + Richardson: u_min -.214043, v_min -.253805
  const std::array<double, 2> exact{-.214043, -.253805};
  const auto coarse = cavity(24), fine = cavity(48);
  for (int c = 0; c < 2; ++c) {
    const double e[2] = {std::fabs(coarse[c] - exact[c]), std::fabs(fine[c] - exact[c])};
    std::printf("  F6 %c_min at 24, 48: %.6f %.6f, exact %.6f, order %.2f\n", "uv"[c], coarse[c], fine[c], exact[c],
                order(e[0], e[1]));
    EXPECT_GT(order(e[0], e[1]), 1.7);
    EXPECT_LT(e[1], 0.01 * std::fabs(exact[c]));
  }
}

// B_xy where the shear stress k B_xy + 4 c3 B_xy^3 of simple shear is `stress`, k = G or 2 (c1 + c2).
double sheared(const Material &m, double stress) {
  double g = stress / m.shear_modulus;
  for (int n = 0; n < 50; ++n)
    g -= (m.shear_modulus * g + 4 * m.c3 * g * g * g - stress) / (m.shear_modulus + 12 * m.c3 * g * g);
  return g;
}

// rms error of u, largest of B_xy inside, and on the wall, of the layers at rest.
std::array<double, 3> layers(int cells, const Material &material) {
  const double mu = 0.1, g = 0.5, solid = 0.5;
  Scene scene;
  GridSpec grid;
  grid.cells = {4, cells, 1};
  grid.length = {4. / cells, 1, 1};
  grid.boundary[1] = Boundary::wall;
  SolverSpec spec = fast_spec(mu);
  spec.fluid.body_force.force = {g, 0, 0};
  EXPECT_EQ(scene.create(PETSC_COMM_SELF, grid, spec), 0);
  scene.add_phase(0, [=](double, double y, double) { return y < solid ? 1.0 : 0.0; }).material = material;
  scene.solver.state().phases[0].material.anchored = true;
  EXPECT_EQ(scene.solver.prepare(), 0);
  EXPECT_EQ(scene.run(60, (material.c3 > 0 ? 450 : 150) * cells), 0);  // below the elastic limit
  const State &state = scene.solver.state();
  const double u_error = rms_error(scene.domain, state.velocity[0], at_face[0], [=](double, double y, double) {
    return y > solid ? g * (y - solid) * (1 - y) / (2 * mu) : 0;
  });
  double shear_error = 0, wall_error = 0;  // the stress is rho g (y_m - y), y_m = (Ls + H)/2, where B evolves
  for (int j = 0; j < cells / 2; ++j) {
    const double exact = sheared(material, g * (0.75 - double(j) / cells));
    double &error = j < 2 ? wall_error : shear_error;
    error = std::max(error, std::fabs(state.phases[0].tensor.field[2](0, j, 0) - exact));
  }
  return {u_error, shear_error, wall_error};
}

TEST(RestingLayer, ConvergesToTheExactState) {
  for (const Material &material : {Material{1}, test::mooney_rivlin(0.3, 0.2, 2)}) {
    const auto coarse = layers(16, material), fine = layers(32, material);
    std::printf("  S3, c3 = %g, at 16, 32: u %.3e %.3e, B_xy %.3e %.3e, at the wall %.3e %.3e\n", material.c3,
                coarse[0], fine[0], coarse[1], fine[1], coarse[2], fine[2]);
    EXPECT_LT(fine[0], 1e-3);
    EXPECT_LT(fine[1], 1e-3 * 0.375);  // of its largest value
    if (material.c3 == 0) {
      EXPECT_GT(order(coarse[0], fine[0]), 1.9);
      EXPECT_LT(fine[2], 1e-3 * 0.375);
    } else {
      EXPECT_GT(order(coarse[0], fine[0]), 1.7);
      EXPECT_GT(order(coarse[1], fine[1]), 1.7);
      EXPECT_GT(order(coarse[2], fine[2]), 0.9);  // tr B, reflected at the wall, makes B_xy there of first order
    }
  }
}

// S12: a disc sheared by a decaying flow recovers its shape, v -> 0 and B -> I inside. What the transport of B has
// lost on the way stays behind as B - I: its mean must vanish with the grid. Largest |v| and rms of B - I, sheared and
// at rest.
std::array<double, 4> recovery(int cells) {
  Scene scene;
  GridSpec grid;
  grid.cells = {cells, cells, 1};
  EXPECT_EQ(scene.create(PETSC_COMM_SELF, grid, fast_spec(0.1)), 0);
  State &state = scene.solver.state();
  set(scene.domain, state.velocity[0], at_face[0],
      [](double, double y, double) { return std::sin(6.28318530717958648 * y); });
  scene.add_phase(1, [=](double x, double y, double) {
    return std::min(1.0, std::max(0.0, 0.5 - cells * (std::hypot(x - 0.5, y - 0.5) - 0.2)));
  });
  EXPECT_EQ(scene.solver.prepare(), 0);
  std::array<double, 4> most{};
  for (const int when : {0, 1}) {
    EXPECT_EQ(scene.run(when ? 20 : 0.2, (when ? 4000 : 80) * cells / 48), 0);
    const Phase &phase = state.phases[0];
    double &speed = most[2 * when], strain = 0, volume = 0;
    for (int j = 0; j < cells; ++j)
      for (int i = 0; i < cells; ++i) {
        const double phi = phase.fraction[0](i, j, 0), xx = phase.tensor.field[0](i, j, 0) - 1,
                     xy = phase.tensor.field[2](i, j, 0);
        speed = std::max(speed, std::fabs(state.velocity[0](i, j, 0)));
        volume += phi;
        strain += phi * (xx * xx + xy * xy);
      }
    most[2 * when + 1] = std::sqrt(strain / volume);
  }
  return most;
}

TEST(Recovery, ShearedDiscReturnsToRest) {
  double last = 0;
  for (const int cells : {24, 48, 96}) {
    const auto most = recovery(cells);
    std::printf("  S12 at %d: |v| %.2e -> %.2e, |B - I| %.2e -> %.2e\n", cells, most[0], most[2], most[1], most[3]);
    EXPECT_GT(most[1], 0.2);
    EXPECT_LT(most[2], 5e-3 * most[0]);
    if (last > 0) {
      EXPECT_GT(order(last, most[3]), 0.5);  // an error of fixed size in a layer of cells at the surface would give 1/2
    }
    last = most[3];
  }
}

}  // namespace
