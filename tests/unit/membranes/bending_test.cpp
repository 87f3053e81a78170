// Bending of membranes: curvatures, energy, and the force as minus its derivative.
#include "kernels/bending.hpp"
#include "membranes/membrane_transport.hpp"
#include "support/interface_scene.hpp"

#include <gtest/gtest.h>

using namespace eulastic;
using namespace eulastic::test;

namespace {

TEST(Bending, SurfaceLevelIsTheQuantileOfTheNormalDistribution) {
  for (const double x : {-3.5, -2.0, -1.0, -0.1, 0.05, 0.7, 1.6, 3.0}) {
    const double psi = 0.5 * std::erfc(x / std::sqrt(2.));
    EXPECT_NEAR(kernels::surface_level(psi), x, 1e-3 * std::fabs(x));
    EXPECT_NEAR(kernels::surface_level(1 - psi), -x, 1e-3 * std::fabs(x));
  }
  EXPECT_EQ(kernels::surface_level(0.5), 0);
  EXPECT_GT(kernels::surface_level(0), 3.5);
}

// The curvatures are those of the level surfaces of any function of the distance from a ball or a tube.
TEST(Bending, CurvaturesAreThoseOfTheSurface) {
  constexpr int n = 3;
  constexpr double h = 0.05, inverse[3] = {1 / h, 1 / h, 1 / h}, radius = 1;
  constexpr std::ptrdiff_t stride[3] = {1, n, n * n};
  for (const bool tube : {false, true})
    for (const double away : {-0.1, 0.0, 0.1}) {
      double level[n * n * n];
      const double r = radius + away, x = 0.48 * r, y = tube ? std::sqrt(1 - 0.48 * 0.48) * r : 0.6 * r;
      const double z = tube ? 0.3 : std::sqrt(1 - 0.48 * 0.48 - 0.36) * r;
      for (int k = 0; k < n; ++k)
        for (int j = 0; j < n; ++j)
          for (int i = 0; i < n; ++i) {
            const double a = x + (i - 1) * h, b = y + (j - 1) * h, c = tube ? 0 : z + (k - 1) * h;
            level[i + n * j + n * n * k] = std::sqrt(a * a + b * b + c * c) - radius;
          }
      const kernels::Curvatures found = kernels::surface_curvatures<3>(level + 13, stride, inverse, 10);
      EXPECT_NEAR(found.sum, tube ? 1 : 2, 0.01);
      EXPECT_NEAR(found.product, tube ? 0 : 1, 0.01);
      const kernels::Curvatures blunt = kernels::surface_curvatures<3>(level + 13, stride, inverse, 0.25);
      EXPECT_EQ(blunt.sum, 0.5);
      EXPECT_NEAR(blunt.product, tube ? 0 : 0.0625, 0.01);
      if (tube) {
        EXPECT_NEAR(kernels::surface_curvatures<2>(level + 4, stride, inverse, 10).sum, 1, 0.01);
      }
    }
}

// Integral of 1/2 (kappa - c0)^2 over an ellipse or an ellipsoid of revolution around x.
double exact_energy(double a, double b, double c0, int dim) {
  constexpr int parts = 4000;
  double sum = 0;
  for (int p = 0; p < parts; ++p) {
    const double t = (p + 0.5) * M_PI / parts, s = std::sin(t), c = std::cos(t);
    const double length = std::hypot(a * s, b * c), in_plane = a * b / (length * length * length);
    const double around = a / (b * length);
    const double k = dim == 2 ? in_plane : in_plane + around;
    sum += 0.5 * (k - c0) * (k - c0) * length * (dim == 2 ? 2 : 2 * M_PI * b * s);
  }
  return sum * M_PI / parts;
}

struct Seen {
  double energy, power, force;
};

// An ellipse or ellipsoid with semi-axes a, b, b in a flow that stretches it at the rate 1 along x.
Seen bend(double a, double b, double c0, int dim, int cells) {
  InterfaceScene scene;
  GridSpec spec;
  spec.cells = {cells, cells, dim == 2 ? 1 : cells};
  spec.length = {1, 1, dim == 2 ? 1. / cells : 1};
  spec.ghosts = 5;
  EXPECT_EQ(scene.create(PETSC_COMM_SELF, spec), 0);
  const Real3 centre{0.51, 0.493, dim == 2 ? 0 : 0.505};
  scene.set_fraction(ellipsoid(centre, {a, b, b}, dim));
  GhostExchange exchange(scene.domain);
  std::vector<Phase> phases(1);
  Phase &phase = phases[0];
  phase.fraction = std::move(scene.fraction);
  phase.tensor.field = undeformed_tensor(scene.domain);
  phase.material.law = Law::membrane;
  phase.material.membrane.bending_modulus = 1;
  phase.material.membrane.spontaneous_curvature = c0;
  EXPECT_EQ(exchange.update_ghosts(phase.fraction, 5), 0);
  EXPECT_EQ(phase.rows.find(scene.domain, phase.fraction[0]), 0);
  Flow flow(scene.domain, {});
  EXPECT_EQ(flow.work.reserve(MembraneTransport::fields), 0);
  flow.now.phases = std::move(phases);
  MembraneTransport membrane(&flow);
  EXPECT_EQ(membrane.start(), 0);
  Field force(scene.domain, dim);
  Seen seen{};
  const double volume = scene.domain.cell_volume() * (dim == 2 ? cells : 1);
  EXPECT_EQ(membrane.add_force(flow.now.phases, 1, true, force), 0);
  scene.each_owned([&](int i, int j, int k) {
    for (int d = 0; d < dim; ++d) {
      std::array<bool, 3> at{true, true, true};
      at[d] = false;
      const double x = scene.position({i, j, k}, at)[d] - centre[d];
      scene.velocity[d](i, j, k) = d == 0 ? x : -x / (dim - 1);
    }
    seen.force += force[0](i, j, k) * volume;
  });
  EXPECT_EQ(exchange.update_ghosts(scene.velocity, 1), 0);
  SurfaceEnergy measured;
  flow.now.velocity = std::move(scene.velocity);
  EXPECT_EQ(membrane.add_surface_energy({flow.now.phases, {}}, &measured, nullptr), 0);
  seen.energy = measured.energy;
  seen.power = measured.power;
  return seen;
}

// The radius has 8 to 9 cells, then one and a half times as many.
TEST(Bending, PowerIsTheChangeOfTheEnergy) {
  for (const int dim : {2, 3})
    for (const double c0 : {0.0, 3.0}) {
      const double a = 0.33, b = 0.25, step = 1e-4, rate = dim == 2 ? 1 : 0.5;
      const double energy = exact_energy(a, b, c0, dim);
      const double change = (exact_energy(a * (1 + step), b * (1 - rate * step), c0, dim) -
                             exact_energy(a * (1 - step), b * (1 + rate * step), c0, dim)) /
                            (2 * step);
      double wrong[2];
      for (const int n : {0, 1}) {
        const Seen seen = bend(a, b, c0, dim, 32 + 16 * n);
        std::printf("  %d-D, c0 = %g, %d cells: energy %.4f of %.4f, power %.4f of %.4f\n", dim, c0, 32 + 16 * n,
                    seen.energy, energy, seen.power, change);
        wrong[n] = std::fabs(seen.power / change - 1);
        EXPECT_NEAR(seen.energy, energy, (n ? 0.04 : 0.09) * energy);
        EXPECT_NEAR(seen.force, 0, 1e-10);
      }
      EXPECT_LT(wrong[0], 0.22);
      EXPECT_LT(wrong[1], 0.6 * wrong[0]);
    }
}

// The force on a ball is that of a pressure, E_b (kappa - c0) c0/R outwards, which vanishes for c0 = 0 and c0 = 2/R.
TEST(Bending, BallsAreAtRest) {
  constexpr double radius = 0.3;
  for (const double c0 : {0.0, 2 / radius}) EXPECT_NEAR(bend(radius, radius, c0, 3, 40).power, 0, 0.05 * 8 * M_PI);
  EXPECT_LT(bend(radius, radius, 2 / radius, 3, 40).energy, 0.01 * 8 * M_PI);
}

}  // namespace
