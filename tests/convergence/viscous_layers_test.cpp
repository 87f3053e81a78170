// Layers of viscosity 1 and lambda, along the grid and across it: steady shear, and the slowest mode.
#include "flow/correction.hpp"
#include "flow/projection.hpp"
#include "flow/super_time_stepping.hpp"
#include "flow/viscous_stress.hpp"
#include "pressure/smac.hpp"
#include "support/polynomials.hpp"

using namespace eulastic;
using namespace eulastic::test;

namespace {

constexpr double pi = 3.14159265358979323846;

Method fast_smac() {
  Method method = method_preset(MethodKind::fast);
  method.pressure = PressureKind::smac;
  return method;
}

void add_layer(Scene &scene, double viscosity, const Function &fraction) {
  scene.add_phase(0, fraction).material.viscosity = viscosity;
}

// Of the wall's velocity. The lower `share` of the height has the viscosity lambda.
double couette_error(double lambda, double share, int cells) {
  Scene scene;
  GridSpec grid;
  grid.cells = {4, cells, 1};
  grid.length = {4. / cells, 1, 1};
  grid.boundary[1] = Boundary::wall;
  SolverSpec spec;
  static_cast<Method &>(spec) = fast_smac();
  spec.sides[1][1].motion.velocity = {1, 0, 0};
  EXPECT_EQ(scene.create(PETSC_COMM_SELF, grid, spec), 0);
  const double h = 1. / cells;
  add_layer(scene, lambda,
            [&](double, double y, double) { return std::min(1.0, std::max(0.0, (share - (y - h / 2)) / h)); });
  EXPECT_EQ(scene.solver.prepare(), 0);
  EXPECT_EQ(scene.run(40 / std::min(lambda, 1.0), 100), 0);
  const double stress = 1 / (share / lambda + 1 - share);
  double worst = 0;
  for (int j = 0; j < cells; ++j) {
    const double y = (j + 0.5) * h, exact = y < share ? stress * y / lambda : 1 - stress * (1 - y);
    worst = std::max(worst, std::fabs(scene.solver.state().velocity[0](0, j, 0) - exact));
  }
  return worst;
}

TEST(ViscousLayers, SteadyShearIsExactOnFaces) {
  for (const double lambda : {0.01, 0.2, 5.0, 100.0}) EXPECT_LT(couette_error(lambda, 0.5, 16), 1e-8) << lambda;
}

TEST(ViscousLayers, SteadyShearOffTheFaces) {
  for (const double lambda : {0.2, 5.0}) {
    double e[3];
    for (int n = 0; n < 3; ++n) e[n] = couette_error(lambda, 0.5 + 0.3 / (16 << n), 16 << n);
    std::printf("  lambda %g, interface .3 h off a face, 16, 32, 64: %.3e %.3e %.3e\n", lambda, e[0], e[1], e[2]);
    EXPECT_LT(e[2], 0.005);
    EXPECT_GT(order(e[0], e[2]) / 2, 0.9);  // of the one cell with the kink
  }
}

// u(s) along the layers, odd about the middle of each; rate k: (mu u')' = -k u.
struct Mode {
  double lambda, length, rate, a, b, ratio;  // wave numbers in 1 and lambda; amplitude in lambda for 1
  Mode(double viscosity, double period) : lambda(viscosity), length(period / 2) {
    // u and mu u' agree at the interface, at half a layer from the middles: tan(b/2)/(lambda b) = -tan(a/2)/a.
    const auto of = [&](double k) {
      const double p = std::sqrt(k), q = std::sqrt(k / lambda), x = p * length / 2, y = q * length / 2;
      return std::sin(x) * lambda * q * std::cos(y) + std::sin(y) * p * std::cos(x);
    };
    double low = 1e-9, high = low;
    while (of(high) > 0) low = high, high *= 1.01;
    for (int n = 0; n < 200; ++n) (of(0.5 * (low + high)) > 0 ? low : high) = 0.5 * (low + high);
    rate = low;
    a = std::sqrt(rate), b = std::sqrt(rate / lambda);
    ratio = std::sin(a * length / 2) / std::sin(b * length / 2);
  }
  // s from the middle of a layer of viscosity 1.
  double operator()(double s) const {
    s -= 2 * length * std::round(s / (2 * length));
    if (std::fabs(s) <= length / 2) return std::sin(a * s);
    return ratio * std::sin(b * (s > 0 ? length - s : -length - s));
  }
};

// Part of a unit square, centred at x, y of the coordinate s = (x + 2 y)/h below `edge`.
double part_below(double edge, double s) {
  const auto ramp = [](double q) { return q > 0 ? q * q / 2 : 0; };
  const double d = edge - s;
  const double area = (ramp(d + 1.5) - ramp(d + 0.5) - ramp(d - 0.5) + ramp(d - 1.5)) / 2;
  return std::min(1.0, std::max(0.0, area));
}

// Layers normal to (1, 2), periodic in this box: .25 ... .75 of every period 2 of x + 2 y are full.
GridSpec box_across(int cells) {
  GridSpec grid;
  grid.cells = {cells, cells / 2, 1};
  grid.length = {2, 1, 1};
  return grid;
}
double layers_across(double x, double y, double h) {
  double sum = 0;
  for (int n = -1; n <= 3; ++n)
    sum += part_below((2 * n + 1.5) / h, (x + 2 * y) / h) - part_below((2 * n + 0.5) / h, (x + 2 * y) / h);
  return sum;
}

struct ShearErrors {
  double largest, rms;
};

// What linear shear of rate 1 leaves unbalanced is let go until nothing moves any more: errors of u over its change
// across both layers.
ShearErrors shear_errors_across(double lambda, int cells) {
  Domain domain;
  EXPECT_EQ(domain.create(PETSC_COMM_SELF, box_across(cells)), 0);
  GhostExchange exchange(domain);
  std::unique_ptr<PressureSolver> solver;
  EXPECT_EQ(SmacSolver::create(domain, exchange, &solver), 0);
  std::vector<Phase> phases(1);
  phases[0].empty(domain, false);
  phases[0].material.viscosity = lambda;
  const double h = domain.spacing()[0], root = std::sqrt(5.);
  fill_everywhere(domain, phases[0].fraction[0], at_centre, [&](const Point &x) {
    return layers_across(x[0] - 2 * std::floor(x[0] / 2), x[1] - std::floor(x[1]), h);
  });
  EXPECT_EQ(phases[0].rows.find(domain, phases[0].fraction[0]), 0);
  LocalViscosity viscosity(domain);
  Field linear(domain, 2), v(domain, 2), star(domain, 2), pressure(domain, 1);
  Field divergence(domain, 1), increment(domain, 1);
  EXPECT_EQ(compute_viscosity(domain, {}, {}, phases, &viscosity), 0);
  fill_everywhere(domain, linear[0], at_face[0], [=](const Point &x) { return 0.4 * (x[0] + 2 * x[1]); });
  fill_everywhere(domain, linear[1], at_face[1], [=](const Point &x) { return -0.2 * (x[0] + 2 * x[1]); });
  SuperTimeStepping work{Field(domain, 2), {}, Field(domain, 2), Field(domain, 2)};
  const double dt = 0.1, viscous = 1 / (4 * std::max(lambda, 1.0) / (h * h));
  for (int n = 0; n < 60; ++n) {
    const ConstView p = pressure[0];
    for (int a = 0; a < 2; ++a)
      for_points(domain, work.rate[a], at_face[a], [&, at = 0](double &rate, double, double, double) mutable {
        const int i = at % cells, j = at / cells;
        rate = (p(i - (a == 0), j - (a == 1), 0) - p(i, j, 0)) / h;
        ++at;
      });
    EXPECT_EQ(add_viscous_force(domain, viscosity, 1, linear, work.rate), 0);
    EXPECT_EQ(add_viscous_force(domain, viscosity, 1, v, work.rate), 0);
    const BoundaryConditions sides{};
    const ViscousStep step{sides, 0, dt, rkl_stages(dt, viscous), v, 1, &viscosity};
    EXPECT_EQ(super_time_step(domain, exchange, step, work, star), 0);
    EXPECT_EQ(exchange.update_ghosts(star, 1), 0);
    EXPECT_EQ(compute_divergence(domain, 1, star, divergence), 0);
    EXPECT_EQ(exchange.update_ghosts(divergence, 1), 0);
    EXPECT_EQ(solver->solve(dt, divergence, pressure, increment), 0);
    EXPECT_EQ(correct_velocity(domain, 1, dt, 0, increment, divergence, star, pressure), 0);
    EXPECT_EQ(apply_rotational_update(domain, viscosity.fields, 0.5, divergence, pressure), 0);
    v.swap(star);
    EXPECT_EQ(exchange.update_ghosts(v, 2), 0);
  }
  // In the layers the rate of shear is T/mu, T = 2/(1 + 1/lambda); departures from 1 add up to 0 in their middles.
  const double stress = 2 / (1 + 1 / lambda), length = 1 / root;
  const auto departure = [&](double s) {
    s -= 2 * length * std::round(s / (2 * length));
    if (std::fabs(s) <= length / 2) return (stress - 1) * s;
    return (stress - 1) * (s > 0 ? length - s : -length - s);
  };
  const auto exact = [&](double x, double y) { return 2 / root * departure((x + 2 * y) / root); };
  const double change = 2 / root * 2 * length;
  return {largest_error(domain, v[0], at_face[0], [&](const Point &x) { return exact(x[0], x[1]); }) / change,
          rms_error(domain, v[0], at_face[0], [&](double x, double y, double) { return exact(x, y); }) / change};
}

TEST(ViscousLayers, SteadyShearAcrossTheGrid) {
  for (const double lambda : {0.2, 5.0}) {
    ShearErrors e[3];
    for (int n = 0; n < 3; ++n) e[n] = shear_errors_across(lambda, 32 << n);
    std::printf("  lambda %g, shear along (1,2), 32, 64, 128: largest %.3e %.3e %.3e, rms %.3e %.3e %.3e\n", lambda,
                e[0].largest, e[1].largest, e[2].largest, e[0].rms, e[1].rms, e[2].rms);
    EXPECT_LT(e[1].rms, 0.002);
    EXPECT_LT(e[2].largest, 0.005);
    EXPECT_GT(order(e[0].rms, e[2].rms) / 2, 1.4);
  }
}

struct ModeErrors {
  double rate, profile;
};

// Flow along (2, -1).
ModeErrors mode_errors(double lambda, int cells) {
  Scene scene;
  SolverSpec spec;
  static_cast<Method &>(spec) = fast_smac();
  spec.fluid.inertia = false;
  EXPECT_EQ(scene.create(PETSC_COMM_SELF, box_across(cells), spec), 0);
  const double root = std::sqrt(5.), period = 2 / root, h = 2. / cells, amplitude = 1e-6;
  const Mode mode(lambda, period);
  const Function exact = [&](double x, double y, double) { return amplitude * mode((x + 2 * y) / root); };
  set(scene.domain, scene.solver.state().velocity[0], at_face[0],
      [&](double x, double y, double z) { return 2 / root * exact(x, y, z); });
  set(scene.domain, scene.solver.state().velocity[1], at_face[1],
      [&](double x, double y, double z) { return -1 / root * exact(x, y, z); });
  add_layer(scene, lambda, [&](double x, double y, double) { return layers_across(x, y, h); });
  EXPECT_EQ(scene.solver.prepare(), 0);
  const auto energy = [&] {
    double sum = 0;
    for (int c = 0; c < 2; ++c)
      for_points(scene.domain, scene.solver.state().velocity[c], at_face[c],
                 [&](double q, double, double, double) { sum += q * q; });
    return sum;
  };
  const double end = 0.5 / mode.rate;
  EXPECT_EQ(scene.run(end / 2, 50), 0);
  const double before = energy();
  EXPECT_EQ(scene.run(end, 50), 0);
  ModeErrors errors{};
  errors.rate = std::fabs(std::log(before / energy()) / (mode.rate * end) - 1);
  const double decay = std::exp(-mode.rate * end);
  errors.profile = rms_error(scene.domain, scene.solver.state().velocity[0], at_face[0],
                             [&](double x, double y, double z) { return 2 / root * decay * exact(x, y, z); }) /
                   (2 / root * decay * amplitude);
  return errors;
}

TEST(ViscousLayers, SlowestModeAcrossTheGrid) {
  for (const double lambda : {0.2, 5.0}) {
    ModeErrors e[3];
    for (int n = 0; n < 3; ++n) e[n] = mode_errors(lambda, 32 << n);
    std::printf("  lambda %g along (1,2), 32, 64, 128: rate %.3e %.3e %.3e, velocity %.3e %.3e %.3e\n", lambda,
                e[0].rate, e[1].rate, e[2].rate, e[0].profile, e[1].profile, e[2].profile);
    EXPECT_LT(e[2].rate, 0.0025);  // 57 cells for both layers
    EXPECT_LT(e[2].profile, 0.003);
    EXPECT_GT(order(e[0].rate, e[2].rate) / 2, 1.9);
    EXPECT_GT(order(e[0].profile, e[2].profile) / 2, 1.5);
  }
}

}  // namespace
