// Pure flow against exact solutions: F1 advected Taylor-Green, F3 channel start-up, F4 Womersley, Stokes' second
// problem. The observed order is asserted and the errors are printed.
#include "support/scene.hpp"

#include <gtest/gtest.h>

#include <complex>

using namespace eulastic;
using namespace eulastic::test;

namespace {

constexpr double pi = 3.14159265358979323846;
using Complex = std::complex<double>;

// L2 error of u at t = 0.5 of Taylor-Green carried by (1, 1) through the unit box, nu = 0.01. Classic: dt = 2 h^2, so
// that Euler's first order in time shows as second order in h; fast: dt = h/10.
double advected_taylor_green(int cells, MethodKind method, PressureKind pressure) {
  const double nu = 0.01, k = 2 * pi, end = 0.5;
  Scene scene;
  GridSpec grid;
  grid.cells = {cells, cells, 1};
  SolverSpec spec;
  static_cast<Method &>(spec) = method_preset(method);
  spec.fluid.viscosity = nu;
  spec.pressure = pressure;
  EXPECT_EQ(scene.create(PETSC_COMM_SELF, grid, spec), 0);
  const auto u = [=](double t) {
    return [=](double x, double y, double) {
      return 1 + std::exp(-2 * nu * k * k * t) * std::sin(k * (x - t)) * std::cos(k * (y - t));
    };
  };
  const auto v = [=](double x, double y, double) { return 1 - std::cos(k * x) * std::sin(k * y); };
  State &state = scene.solver.state();
  set(scene.domain, state.velocity[0], at_face[0], u(0));
  set(scene.domain, state.velocity[1], at_face[1], v);
  set(scene.domain, state.pressure[0], at_centre,
      [=](double x, double y, double) { return 0.25 * (std::cos(2 * k * x) + std::cos(2 * k * y)); });
  EXPECT_EQ(scene.solver.prepare(), 0);
  EXPECT_EQ(scene.run(end, method == MethodKind::fast ? 5 * cells : cells * cells / 4), 0);
  return rms_error(scene.domain, state.velocity[0], at_face[0], u(end));
}

class AdvectedTaylorGreen : public ::testing::TestWithParam<std::pair<MethodKind, PressureKind>> {};

TEST_P(AdvectedTaylorGreen, SecondOrder) {
  const auto [method, pressure] = GetParam();
  double e[3];
  for (int n = 0; n < 3; ++n) e[n] = advected_taylor_green(16 << n, method, pressure);
  std::printf("  F1 L2(u) at 16, 32, 64: %.3e %.3e %.3e, orders %.2f %.2f\n", e[0], e[1], e[2], order(e[0], e[1]),
              order(e[1], e[2]));
  EXPECT_GT(order(e[1], e[2]), 1.9);
  EXPECT_LT(e[2], 7e-3);
}

INSTANTIATE_TEST_SUITE_P(Methods, AdvectedTaylorGreen,
                         ::testing::Values(std::pair(MethodKind::classic, PressureKind::acm),
                                           std::pair(MethodKind::classic, PressureKind::smac),
                                           std::pair(MethodKind::fast, PressureKind::acm),
                                           std::pair(MethodKind::fast, PressureKind::smac)),
                         [](const auto &test) {
                           return std::string(test.param.first == MethodKind::fast ? "fast" : "classic") +
                                  (test.param.second == PressureKind::acm ? "_acm" : "_smac");
                         });

// A channel of height 1 along x with walls in y, thin in x and z, run to `end`; returns the rms error of u.
double channel(int cells, const SolverSpec &spec, double end, bool three_d, const Function &start,
               const Function &exact) {
  Scene scene;
  GridSpec grid;
  grid.cells = {4, cells, three_d ? 4 : 1};
  grid.boundary[1] = Boundary::wall;
  EXPECT_EQ(scene.create(PETSC_COMM_SELF, grid, spec), 0);
  State &state = scene.solver.state();
  if (start) set(scene.domain, state.velocity[0], at_face[0], start);
  EXPECT_EQ(scene.solver.prepare(), 0);
  const double nu = spec.fluid.kinematic_viscosity();
  const double S = cells * cells + (three_d ? 32 : 16);
  EXPECT_EQ(scene.run(end, static_cast<int>(std::ceil(end * 2 * nu * S / 0.5))), 0);
  return rms_error(scene.domain, state.velocity[0], at_face[0], exact);
}

TEST(Channel, StartUpConvergesAtOrderTwo) {  // F3, g = H = nu = 1
  const auto exact = [](double t) {
    return [=](double, double y, double) {
      double u = y * (1 - y) / 2;
      for (int m = 1; m < 400; m += 2)
        u -= 4 / std::pow(m * pi, 3) * std::sin(m * pi * y) * std::exp(-m * m * pi * pi * t);
      return u;
    };
  };
  SolverSpec spec;
  spec.fluid.body_force.force = {1, 0, 0};
  for (const double t : {0.05, 0.2}) {
    const double e[3] = {channel(8, spec, t, false, {}, exact(t)), channel(16, spec, t, true, {}, exact(t)),
                         channel(32, spec, t, false, {}, exact(t))};
    std::printf("  F3 t = %g: %.3e %.3e %.3e, orders %.2f %.2f\n", t, e[0], e[1], e[2], order(e[0], e[1]),
                order(e[1], e[2]));
    EXPECT_GT(order(e[0], e[1]), 1.9);
    EXPECT_GT(order(e[1], e[2]), 1.9);
    EXPECT_LT(e[2], 1.25e-4);  // 0.1 % of the steady maximum 1/8
  }
}

TEST(Channel, WomersleyConvergesAtOrderTwo) {  // F4, H = 1, nu = 0.05, K = 1, omega = 2 pi
  const double nu = 0.05, omega = 2 * pi;
  const auto exact = [=](double t) {
    return [=](double, double y, double) {
      const Complex i(0, 1), k = std::sqrt(i * omega / nu);
      return (1.0 / (i * omega) * (1.0 - std::cosh(k * (y - 0.5)) / std::cosh(k * 0.5)) * std::exp(i * omega * t))
          .real();
    };
  };
  SolverSpec spec;
  spec.fluid.viscosity = nu;
  spec.fluid.body_force = {{1, 0, 0}, omega, 0};
  const double t = 0.375;
  const double e[3] = {channel(16, spec, t, false, exact(0), exact(t)), channel(32, spec, t, false, exact(0), exact(t)),
                       channel(64, spec, t, false, exact(0), exact(t))};
  std::printf("  F4: %.3e %.3e %.3e, orders %.2f %.2f\n", e[0], e[1], e[2], order(e[0], e[1]), order(e[1], e[2]));
  EXPECT_GT(order(e[1], e[2]), 1.9);
  EXPECT_LT(e[2], 1e-3);
}

TEST(Channel, OscillatingWallConvergesAtOrderTwo) {  // Stokes 2: u = Im{U sinh(ky)/sinh(kH) e^{i omega t}}
  const double nu = 0.1, omega = 2 * pi;
  const auto exact = [=](double t) {
    return [=](double, double y, double) {
      const Complex i(0, 1), k = std::sqrt(i * omega / nu);
      return (std::sinh(k * y) / std::sinh(k) * std::exp(i * omega * t)).imag();
    };
  };
  SolverSpec spec;
  spec.fluid.viscosity = nu;
  spec.sides[1][1].motion = {{1, 0, 0}, omega, -pi / 2};  // U sin(omega t)
  const double t = 0.6;
  const double e[3] = {channel(16, spec, t, false, exact(0), exact(t)), channel(32, spec, t, true, exact(0), exact(t)),
                       channel(64, spec, t, false, exact(0), exact(t))};
  std::printf("  Stokes 2: %.3e %.3e %.3e, orders %.2f %.2f\n", e[0], e[1], e[2], order(e[0], e[1]), order(e[1], e[2]));
  EXPECT_GT(order(e[1], e[2]), 1.9);
  EXPECT_LT(e[2], 1e-3);
}

}  // namespace
