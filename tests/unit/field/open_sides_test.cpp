// Boundaries that fluid crosses: mirrored and rotated scenes, exact flows, and a vortex that leaves.
#include "field/open_boundaries.hpp"
#include "grid/domain.hpp"
#include "support/scene.hpp"

#include <gtest/gtest.h>

using namespace eulastic;
using namespace eulastic::test;

namespace {

using Kinds = std::array<std::array<BoundaryKind, 2>, 3>;

struct Setting {
  Int3 cells{18, 16, 14};
  Real3 length{9, 8, 7};
  Kinds kind{};
  double inflow = 1, frequency = 2, pressure = 0.7;
  double viscosity = 0.3;
  Real3 force{0.4, 0.2, -0.3};
  PressureKind solver = PressureKind::acm;
  MethodKind method = MethodKind::fast;

  // Inflow along y, outflow along y and x, beside a wall and planes of symmetry.
  Setting() {
    kind[0] = {BoundaryKind::symmetry, BoundaryKind::pressure};
    kind[1] = {BoundaryKind::inflow, BoundaryKind::outflow};
    kind[2] = {BoundaryKind::wall, BoundaryKind::symmetry};
  }
};

Setting mirrored(Setting s, int d) {
  s.force[d] = -s.force[d];
  std::swap(s.kind[d][0], s.kind[d][1]);
  return s;
}

Setting flat(Setting s) {
  s.cells[2] = 1;
  s.kind[2] = {};
  s.force[2] = 0;
  return s;
}

void create(const Setting &s, Scene &scene) {
  GridSpec grid;
  grid.cells = s.cells;
  grid.length = s.length;
  SolverSpec spec;
  static_cast<Method &>(spec) = method_preset(s.method);
  spec.pressure = s.solver;
  spec.fluid.viscosity = s.viscosity;
  spec.fluid.body_force.force = s.force;
  for (int d = 0; d < (s.cells[2] == 1 ? 2 : 3); ++d) {
    grid.boundary[d] = Boundary::wall;
    for (int high = 0; high < 2; ++high) {
      BoundaryCondition &side = spec.sides[d][high];
      side.kind = s.kind[d][high];
      grid.open[d][high] = is_open(side.kind);
      if (side.kind == BoundaryKind::inflow) side.given = {s.inflow, s.frequency, 0.1, {}};
      if (side.kind == BoundaryKind::pressure) side.given = {s.pressure, s.frequency, 0.2, {}};
    }
  }
  ASSERT_EQ(scene.create(PETSC_COMM_SELF, grid, spec), 0);
}

void run(const Setting &s, Scene &scene, int steps = 20) {
  create(s, scene);
  ASSERT_EQ(scene.solver.prepare(), 0);
  ASSERT_EQ(scene.run(1, steps), 0);
}

// Largest |a - map(b)| over velocity and pressure.
template <class Map>
double difference(const Scene &a, const Scene &b, Map map) {
  const State &p = a.solver.state(), &q = b.solver.state();
  double largest = 0;
  const auto compare = [&](ConstView x, const Field &y, const Staggering &at, int c) {
    for (int k = 0; k < a.domain.points_end(2, at[2]); ++k)
      for (int j = 0; j < a.domain.points_end(1, at[1]); ++j)
        for (int i = 0; i < a.domain.points_end(0, at[0]); ++i)
          largest = std::max(largest, std::fabs(x(i, j, k) - map(y, at, Int3{i, j, k}, c)));
  };
  for (int c = 0; c < a.domain.dimension(); ++c) compare(p.velocity[c], q.velocity, at_face[c], c);
  compare(p.pressure[0], q.pressure, at_centre, -1);
  return largest;
}

double mirror_difference(const Scene &a, const Scene &b, int m) {
  return difference(a, b, [&](const Field &y, const Staggering &at, Int3 point, int c) {
    point[m] = a.domain.domain_cells()[m] - 1 + at[m] - point[m];
    return (c == m ? -1 : 1) * y[std::max(c, 0)](point[0], point[1], point[2]);
  });
}

// Returns the flow rate into the box through one boundary.
double flow_rate(const Scene &scene, int d, bool high) {
  const Domain &domain = scene.domain;
  const ConstView v = scene.solver.state().velocity[d];
  Int3 begin{}, end = domain.cells();
  begin[d] = high ? end[d] : 0;
  end[d] = begin[d] + 1;
  double sum = 0;
  for (int k = begin[2]; k < end[2]; ++k)
    for (int j = begin[1]; j < end[1]; ++j)
      for (int i = begin[0]; i < end[0]; ++i) sum += v(i, j, k);
  return (high ? -sum : sum) * domain.cell_volume() / domain.spacing()[d];
}

}  // namespace

// V-cycles over odd numbers of cells, transforms and sums along x are not symmetric under reflection.
TEST(OpenSides, MirroredSceneGivesTheMirroredResult) {
  for (const bool two_d : {false, true})
    for (const MethodKind method : {MethodKind::fast, MethodKind::classic}) {
      Setting setting;
      setting.method = method;
      if (method == MethodKind::fast) setting.solver = PressureKind::smac;
      if (two_d) setting = flat(setting);
      Scene original;
      run(setting, original);
      for (int d = 0; d < original.domain.dimension(); ++d) {
        Scene image;
        run(mirrored(setting, d), image);
        const double e = mirror_difference(original, image, d);
        std::printf("  mirrored in %c: %g\n", "xyz"[d], e);
        if (d > 0 && method == MethodKind::classic)
          EXPECT_EQ(e, 0) << "xyz"[d];
        else
          EXPECT_LT(e, 1e-12);
        EXPECT_GT(mirror_difference(original, original, d), 1e-3) << "the scene itself is not symmetric";
      }
    }
}

TEST(OpenSides, RotatedSceneGivesTheRotatedResult) {
  const Setting setting;
  Setting turned = setting;
  for (int d = 0; d < 3; ++d) {
    const int to = (d + 1) % 3;
    turned.cells[to] = setting.cells[d];
    turned.length[to] = setting.length[d];
    turned.kind[to] = setting.kind[d];
    turned.force[to] = setting.force[d];
  }
  Scene original, rotated;
  run(setting, original);
  run(turned, rotated);
  const double e = difference(original, rotated, [&](const Field &y, const Staggering &, const Int3 &x, int c) {
    return y[c < 0 ? 0 : (c + 1) % 3](x[2], x[0], x[1]);
  });
  EXPECT_LT(e, 1e-11);
}

TEST(OpenSides, AllPressureSolversAgreeAndVolumeBalances) {
  Scene exact;
  Setting setting = flat(Setting());
  setting.solver = PressureKind::smac;
  run(setting, exact);
  double crossing = 0, sum = 0;
  for (int d = 0; d < 2; ++d)
    for (const bool high : {false, true}) {
      sum += flow_rate(exact, d, high);
      crossing = std::max(crossing, std::fabs(flow_rate(exact, d, high)));
    }
  EXPECT_GT(crossing, 1);
  EXPECT_LT(std::fabs(sum), 1e-12 * crossing);
  EXPECT_NEAR(flow_rate(exact, 1, false), 9 * std::cos(2.1), 1e-12);
  for (const PressureKind solver : {PressureKind::acm, PressureKind::ksp}) {
    setting.solver = solver;
    Scene other;
    run(setting, other);
    EXPECT_LT(difference(exact, other,
                         [](const Field &y, const Staggering &, const Int3 &x, int c) {
                           return y[std::max(c, 0)](x[0], x[1], x[2]);
                         }),
              1e-5);
  }
}

// A uniform flow follows the inflow, driven by the pressure p = -x du/dt.
TEST(OpenSides, PlugFlowFollowsTheInflow) {
  Setting setting = flat(Setting());
  setting.kind = {};
  setting.kind[0] = {BoundaryKind::inflow, BoundaryKind::pressure};
  setting.kind[1] = {BoundaryKind::symmetry, BoundaryKind::symmetry};
  setting.pressure = 0;
  setting.force = {};
  setting.solver = PressureKind::smac;
  double error[2];
  for (const int fine : {0, 1}) {
    Scene scene;
    const int steps = fine ? 40 : 20;
    run(setting, scene, steps);
    const State &state = scene.solver.state();
    const double u = std::cos(2.1), middle = 1 - 0.5 / steps;
    EXPECT_LT(rms_error(scene.domain, state.velocity[0], at_face[0], [&](double, double, double) { return u; }), 1e-12);
    EXPECT_LT(rms_error(scene.domain, state.velocity[1], at_face[1], [](double, double, double) { return 0; }), 1e-12);
    error[fine] = rms_error(scene.domain, state.pressure[0], at_centre,
                            [&](double x, double, double) { return (x - 9) * 2 * std::sin(2 * middle + 0.1); });
  }
  std::printf("  pressure: %g %g\n", error[0], error[1]);
  EXPECT_LT(error[1], 1e-3 * 18);
  EXPECT_GT(order(error[0], error[1]), 1.9);
}

// Between two pressures from rest: u = sum over odd n of 4 G/(rho H nu k^3) sin(k y) (1 - exp(-nu k^2 t)), k = n pi/H.
TEST(OpenSides, PlaneFlowStartsBetweenTwoPressures) {
  for (const int along : {0, 1})
    for (const MethodKind method : {MethodKind::fast, MethodKind::classic}) {
      double error[2];
      for (const int fine : {0, 1}) {
        const int across = 1 - along, n = fine ? 24 : 12;
        Setting setting;
        setting.cells = {n, n, 1};
        setting.length = {1, 1, 1};
        setting.kind = {};
        setting.kind[along] = {BoundaryKind::outflow, BoundaryKind::pressure};
        setting.pressure = 2;
        setting.frequency = 0;
        setting.viscosity = 0.2;
        setting.force = {};
        setting.method = method;
        setting.solver = PressureKind::smac;
        Scene scene;
        run(setting, scene, method == MethodKind::fast ? (fine ? 40 : 20) : (fine ? 1600 : 400));
        const double G = 2 * std::cos(0.2), nu = 0.2;
        const auto exact = [&](double x, double y, double) {
          double u = 0;
          for (int m = 1; m < 40; m += 2) {
            const double k = m * M_PI;
            u -= 4 * G / (nu * k * k * k) * std::sin(k * (across ? y : x)) * (1 - std::exp(-nu * k * k));
          }
          return u;
        };
        const State &state = scene.solver.state();
        error[fine] = rms_error(scene.domain, state.velocity[along], at_face[along], exact);
        EXPECT_LT(rms_error(scene.domain, state.pressure[0], at_centre,
                            [&](double x, double y, double) { return G * (along ? y : x); }),
                  1e-10);
      }
      std::printf("  along %c: %g %g, order %.2f\n", "xy"[along], error[0], error[1], order(error[0], error[1]));
      EXPECT_LT(error[1], 2e-3);
      EXPECT_GT(order(error[0], error[1]), 1.9);
    }
}

// A smooth jet into a wider box with a pressure boundary: the flow through the middle and the outflow are of second
// order.
TEST(OpenSides, ASpreadingJetIsOfSecondOrder) {
  double flux[4][2];
  for (int level = 0; level < 4; ++level) {
    const int n = 8 << level;
    Setting setting;
    setting.cells = {n, n, 1};
    setting.length = {1, 1, 1};
    setting.kind = {};
    setting.kind[0] = {BoundaryKind::symmetry, BoundaryKind::symmetry};
    setting.kind[1] = {BoundaryKind::inflow, BoundaryKind::pressure};
    setting.frequency = 0;
    setting.viscosity = 0.05;
    setting.force = {};
    setting.solver = PressureKind::smac;
    Scene made;
    create(setting, made);
    InflowProfile profile;
    for (int i = 0; i < n; ++i) profile.push_back(1 + 0.5 * std::cos(M_PI * (i + 0.5) / n));
    SolverSpec spec = made.solver.spec();
    spec.sides[1][0].profile = std::make_shared<const InflowProfile>(profile);
    Scene jet;
    ASSERT_EQ(jet.create(PETSC_COMM_SELF, made.domain.spec(), spec), 0);
    ASSERT_EQ(jet.solver.prepare(), 0);
    ASSERT_EQ(jet.run(0.5, 20 << level), 0);
    const ConstView v = jet.solver.state().velocity[1];
    for (const int leaves : {0, 1}) {
      flux[level][leaves] = 0;
      for (int i = 0; i < n; ++i) flux[level][leaves] += std::pow(v(i, leaves ? n : n / 2, 0), 2) / n;
    }
  }
  for (const int leaves : {0, 1}) {
    const auto change = [&](int level) { return std::fabs(flux[level + 1][leaves] - flux[level][leaves]); };
    std::printf("  %.8f, orders %.2f %.2f\n", flux[3][leaves], order(change(0), change(1)),
                order(change(1), change(2)));
    EXPECT_GT(order(change(1), change(2)), leaves ? 1.5 : 1.7);
  }
}

// A vortex in a stream, strong enough to cause backflow through the boundary where it leaves.
TEST(OpenSides, AVortexLeavesAndNothingGrows) {
  for (const BoundaryKind kind : {BoundaryKind::outflow, BoundaryKind::pressure}) {
    Setting setting;
    setting.cells = {64, 32, 1};
    setting.length = {2, 1, 1};
    setting.kind = {};
    setting.kind[0] = {BoundaryKind::inflow, kind};
    setting.kind[1] = {BoundaryKind::symmetry, BoundaryKind::symmetry};
    setting.frequency = setting.pressure = 0;
    setting.viscosity = 1e-3;
    setting.force = {};
    Scene scene;
    create(setting, scene);
    State &state = scene.solver.state();
    const auto stream = [](double x, double y) {  // 2.5 times the stream at .1 from its centre
      return 0.412 * std::exp(-((x - 1.5) * (x - 1.5) + (y - 0.45) * (y - 0.45)) / 0.02);
    };
    const double d = 1e-4, in = std::cos(0.1);
    set(scene.domain, state.velocity[0], at_face[0],
        [&](double x, double y, double) { return in + (stream(x, y + d) - stream(x, y - d)) / (2 * d); });
    set(scene.domain, state.velocity[1], at_face[1],
        [&](double x, double y, double) { return -(stream(x + d, y) - stream(x - d, y)) / (2 * d); });
    ASSERT_EQ(scene.solver.prepare(), 0);
    FlowExtremes extremes;
    double fastest = 0, back = 0;
    for (int n = 0; n < 12; ++n) {
      ASSERT_EQ(scene.run(state.time + 0.25, 60), 0);
      ASSERT_EQ(scene.solver.measure(&extremes), 0);
      fastest = std::max(fastest, extremes.max_speed());
      for (int j = 0; j < 32; ++j) back = std::min(back, state.velocity[0](64, j, 0));
    }
    std::printf("  fastest %g, at the end %g, backflow %g\n", fastest, extremes.max_speed(), back);
    EXPECT_LT(fastest, 4);
    EXPECT_LT(extremes.max_speed(), 1.3);
  }
}
