// A ring in two dimensions that bends back to a disc, and one that slips back along itself: the rates. The exact ones
// are eigenvalues of Stokes flow in the same periodic box, by Fourier transforms; unbounded they are 5/4 E_b/(mu R^3),
// that of a drop (tests/reference/ring_2d.csv) times n^2 - 3/2, n = 2, and 2 G_s/(mu R) (E_s = 4 G_s there).
#include "solver/synchronised_state.hpp"
#include "support/interface_scene.hpp"
#include "support/scene.hpp"

#include <gtest/gtest.h>

using namespace eulastic;
using namespace eulastic::test;

namespace {

constexpr double side = 4;  // of the periodic box, in radii

PetscErrorCode make(int cells, double stretch, const Membrane &membrane, double density, Scene *scene) {
  PetscFunctionBeginUser;
  GridSpec grid;
  grid.cells = {cells, cells, 1};
  grid.length = {side, side, 1};
  SolverSpec spec;
  static_cast<Method &>(spec) = method_preset(MethodKind::fast);
  spec.pressure = PressureKind::smac;
  spec.fluid.density = density;
  spec.fluid.viscosity = 1;
  spec.fluid.inertia = false;
  PetscCall(scene->create(PETSC_COMM_SELF, grid, spec));
  const double h = side / cells, a = stretch, cx = side / 2 + 0.3 * h, cy = side / 2 + 0.1 * h;
  const Position ellipse = [=](const Real3 &x) {
    const double u = (x[0] - cx) / a, v = (x[1] - cy) * a, level = std::hypot(u, v);
    return level > 0 ? (level - 1) * level / std::hypot(u / a, v * a) : -1.0;
  };
  Phase &phase = scene->add_phase(0, [&](double x, double y, double z) {
    return cell_fraction(ellipse, {x, y, z}, {h, h, 1}, 2);
  });
  phase.material.law = Law::membrane;
  phase.tensor.centred = true;
  phase.material.membrane = membrane;
  PetscFunctionReturn(0);
}

// An ellipse whose membrane has come from a disc, stretched alike: next to nothing bends it back, but its strain, along
// the surface, relaxes.
double slip_rate(int cells) {
  Membrane membrane;
  membrane.shear_modulus = 0.25;
  constexpr double stretch = 1.02;
  Scene scene;
  EXPECT_EQ(make(cells, stretch, membrane, 1e-3, &scene), 0);
  Field &B = scene.solver.state().phases[0].tensor.field;
  for (int c = 0; c < 2; ++c)
    set(scene.domain, B[c], at_centre,
        [=](double, double, double) { return c == 0 ? stretch * stretch : 1 / (stretch * stretch); });
  EXPECT_EQ(scene.solver.prepare(), 0);
  const auto energy = [&] {
    SurfaceEnergy measured;
    EXPECT_EQ(scene.solver.surface_energy(&measured), 0);
    return measured.energy;
  };
  const int steps = cells / 4;
  EXPECT_EQ(scene.run(0.25, steps / 2), 0);
  const double first = energy();
  EXPECT_EQ(scene.run(1.25, 2 * steps), 0);
  return -0.5 * std::log(energy() / first);
}

double elongation(Scene &scene) {
  const std::vector<Phase> *phases = nullptr;
  EXPECT_EQ(scene.solver.synchronised().phases(&phases), 0);
  double sum = 0;
  for_points(scene.domain, ConstView((*phases)[0].fraction[0]), at_centre,
             [&](const double &q, double x, double y, double) {
               sum += q * ((x - side / 2) * (x - side / 2) - (y - side / 2) * (y - side / 2));
             });
  return sum * scene.domain.cell_volume();
}

// Of E_b = 1, an ellipse whose axes are as 1.21.
double bending_rate(int cells) {
  Membrane membrane;
  membrane.bending_modulus = 1;
  Scene scene;
  EXPECT_EQ(make(cells, 1.1, membrane, 1e-3, &scene), 0);
  EXPECT_EQ(scene.solver.prepare(), 0);
  const double h = side / cells;
  const int steps = static_cast<int>(std::ceil(0.2 / (0.8 * h * h * h)));  // .4 of the limit
  EXPECT_EQ(scene.run(0.2, steps), 0);
  const double first = elongation(scene);
  EXPECT_EQ(scene.run(0.6, 2 * steps), 0);
  return -std::log(elongation(scene) / first) / 0.4;
}

TEST(Ring, BendsBackAtTheRateOfStokesFlow) {
  const double rate[2] = {bending_rate(32), bending_rate(64)}, exact = 0.816;
  std::printf("  rate of bending, 8 and 16 cells per radius: %.4f %.4f, exact %.4f\n", rate[0], rate[1], exact);
  EXPECT_NEAR(rate[0], exact, 0.12 * exact);
  EXPECT_NEAR(rate[1], exact, 0.08 * exact);
  EXPECT_LT(std::fabs(rate[1] - exact), std::fabs(rate[0] - exact));
}

TEST(Ring, SlipsBackAtTheRateOfStokesFlow) {
  double rate[3];
  for (int n = 0; n < 3; ++n) rate[n] = slip_rate(32 << n);
  const double exact = 0.4547;
  std::printf("  rate of slip, 8, 16 and 32 cells per radius: %.4f %.4f %.4f, exact %.4f\n", rate[0], rate[1], rate[2],
              exact);
  EXPECT_NEAR(rate[1], exact, 0.15 * exact);
  EXPECT_NEAR(rate[2], exact, 0.07 * exact);
  EXPECT_LT(std::fabs(rate[1] - exact), 0.6 * std::fabs(rate[0] - exact));
}

}  // namespace
