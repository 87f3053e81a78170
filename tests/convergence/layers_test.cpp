// S1: a solid layer under fluid between a fixed and an oscillating wall; exact at any amplitude.
#include "support/scene.hpp"

#include <gtest/gtest.h>

#include <complex>

using namespace eulastic;
using namespace eulastic::test;

namespace {

using Complex = std::complex<double>;
constexpr double pi = 3.14159265358979323846;

// u = Im{uh e^{i omega t}}, B_xy = Im{uh'/(i omega) e^{i omega t}} (S1 of the references, rho = V = 1).
struct Layers {
  double mu, G, omega, solid, solid_mu;  // `solid`: thickness of the solid, box height 1
  Complex ks, kf, a, b, c;
  Layers(double viscosity, double modulus, double frequency, double thickness, double contrast = 1)
      : mu(viscosity), G(modulus), omega(frequency), solid(thickness), solid_mu(contrast * viscosity) {
    const Complex i(0, 1), ms = solid_mu + G / (i * omega);
    ks = std::sqrt(i * omega / ms);
    kf = std::sqrt(i * omega / mu);
    const double fluid = 1 - solid;
    const Complex ratio = ms * ks / (mu * kf);
    a = 1.0 / (std::cosh(kf * fluid) * std::sinh(ks * solid) + ratio * std::cosh(ks * solid) * std::sinh(kf * fluid));
    c = a * std::sinh(ks * solid);
    b = ratio * a * std::cosh(ks * solid);
  }
  Complex velocity(double y) const {
    if (y < solid) return a * std::sinh(ks * y);
    return b * std::sinh(kf * (y - solid)) + c * std::cosh(kf * (y - solid));
  }
  double u(double y, double t) const { return (velocity(y) * std::exp(Complex(0, omega * t))).imag(); }
  double shear(double y, double t) const {
    if (y > solid) return 0;
    return (a * ks * std::cosh(ks * y) / Complex(0, omega) * std::exp(Complex(0, omega * t))).imag();
  }
};

// u along y after `end`, starting from the exact state.
std::vector<double> layer_velocity(const Layers &layers, int cells, int steps, double end, const Method &method) {
  Scene scene;
  GridSpec grid;
  grid.cells = {4, cells, 1};
  grid.length = {4. / cells, 1, 1};
  grid.boundary[1] = Boundary::wall;
  SolverSpec spec;
  static_cast<Method &>(spec) = method;
  spec.fluid.viscosity = layers.mu;
  spec.sides[1][1].motion = {{1, 0, 0}, layers.omega, -pi / 2};
  EXPECT_EQ(scene.create(PETSC_COMM_SELF, grid, spec), 0);
  State &state = scene.solver.state();
  set(scene.domain, state.velocity[0], at_face[0], [&](double, double y, double) { return layers.u(y, 0); });
  const double h = 1. / cells;
  Phase &phase = scene.add_phase(
      layers.G,
      [&](double, double y, double) { return std::min(1.0, std::max(0.0, (layers.solid - (y - h / 2)) / h)); }, true);
  if (layers.solid_mu != layers.mu) phase.material.viscosity = layers.solid_mu;
  const Staggering edge{true, true, false};
  set(scene.domain, phase.tensor.field[2], edge, [&](double, double y, double) { return layers.shear(y, 0); });
  set(scene.domain, phase.tensor.field[0], at_centre,
      [&](double, double y, double) { return 1 + std::pow(layers.shear(y, 0), 2); });
  EXPECT_EQ(scene.solver.prepare(), 0);
  EXPECT_EQ(scene.run(end, steps), 0);
  std::vector<double> u;
  for (int j = 0; j < cells; ++j) u.push_back(state.velocity[0](0, j, 0));
  return u;
}

double rms(const std::vector<double> &a, const std::vector<double> &b) {
  double sum = 0;
  for (std::size_t j = 0; j < a.size(); ++j) sum += std::pow(a[j] - b[j], 2);
  return std::sqrt(sum / double(a.size()));
}

// Relative to the velocity of the wall, 1.
double layer_error(const Layers &layers, int cells, int steps, double end, const Method &method) {
  std::vector<double> exact;
  for (int j = 0; j < cells; ++j) exact.push_back(layers.u((j + 0.5) / cells, end));
  return rms(layer_velocity(layers, cells, steps, end, method), exact);
}

Method fast_smac() {
  Method method = method_preset(MethodKind::fast);
  method.pressure = PressureKind::smac;
  method.viscous_tolerance = 1e-4;  // below the errors that are measured
  return method;
}

TEST(Layers, ReferenceAmplitudes) {  // mu = 1, G = 5, omega = pi
  const Layers layers(1, 5, pi, 0.5);
  EXPECT_NEAR(std::abs(layers.velocity(0.5)), .43700328, 1e-8);
  EXPECT_NEAR(std::abs(layers.a * layers.ks / Complex(0, pi)), .29522648, 1e-8);
}

void expect_order(double thickness, double least, const char *name) {
  const Layers layers(1, 5, pi, thickness);
  double e[3];
  for (int n = 0; n < 3; ++n) e[n] = layer_error(layers, 16 << n, 256 << n, 2, fast_smac());
  std::printf("  S1 %s, 16, 32, 64: %.3e %.3e %.3e, orders %.2f %.2f\n", name, e[0], e[1], e[2], order(e[0], e[1]),
              order(e[1], e[2]));
  EXPECT_GT(order(e[0], e[1]), least);
  EXPECT_GT(order(e[1], e[2]), least);
}

TEST(Layers, FastConvergesOnAFace) { expect_order(0.5, 1.9, "on a face"); }
TEST(Layers, FastConvergesOffTheFaces) { expect_order(0.5 + 1. / 48, 1.5, "off the faces"); }

// The solid has a viscosity of its own.
TEST(Layers, FastConvergesWithTwoViscosities) {
  for (const double contrast : {0.1, 5.0}) {
    const Layers layers(1, 5, pi, 0.5, contrast);
    double e[3];
    for (int n = 0; n < 3; ++n) e[n] = layer_error(layers, 16 << n, 256 << n, 2, fast_smac());
    std::printf("  S1, mu_s/mu_f = %g, 16, 32, 64: %.3e %.3e %.3e, orders %.2f %.2f\n", contrast, e[0], e[1], e[2],
                order(e[0], e[1]), order(e[1], e[2]));
    EXPECT_LT(e[2], 5e-4);
    EXPECT_GT(order(e[0], e[1]), 1.9);
    EXPECT_GT(order(e[1], e[2]), 1.9);
  }
}

TEST(Layers, FastIsSecondOrderInTime) {
  const Layers layers(1, 5, pi, 0.5);
  const double end = 0.6;
  const std::vector<double> limit = layer_velocity(layers, 64, 2048, end, fast_smac());
  double e[3];
  for (int n = 0; n < 3; ++n) e[n] = rms(layer_velocity(layers, 64, 16 << n, end, fast_smac()), limit);
  std::printf("  S1 in time, 16, 32, 64 steps: %.3e %.3e %.3e, orders %.2f %.2f\n", e[0], e[1], e[2], order(e[0], e[1]),
              order(e[1], e[2]));
  EXPECT_GT(order(e[0], e[1]), 1.9);
  EXPECT_GT(order(e[1], e[2]), 1.9);
}

}  // namespace
