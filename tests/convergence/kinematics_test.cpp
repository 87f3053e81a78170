// S5: B carried by a prescribed velocity: homogeneous deformations, rigid rotation, and the Taylor-Green cell.
#include "support/scene.hpp"

#include "solids/transport.hpp"

#include <gtest/gtest.h>

using namespace eulastic;
using namespace eulastic::test;

namespace {

constexpr double pi = 3.14159265358979323846;
using Matrix = std::array<Real3, 3>;
constexpr Matrix identity{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};

// A box full of solid in a velocity that nobody changes; ghosts included.
struct Kinematics {
  Domain domain;
  Field velocity, next;
  Phase phase;

  template <class Velocity>
  Kinematics(const Int3 &cells, const Matrix &B, Velocity v) {
    GridSpec spec;
    spec.cells = cells;
    EXPECT_EQ(domain.create(PETSC_COMM_SELF, spec), 0);
    velocity = Field(domain, domain.dimension());
    const auto &components = tensor_components(domain.dimension());
    phase.fraction = Field(domain, 1);
    phase.tensor.rule = reset_below_one_per_cent;
    phase.fraction.fill(0, 1.0);
    phase.tensor.field = Field(domain, static_cast<int>(components.size()));
    for (int c = 0; c < phase.tensor.field.count(); ++c)
      phase.tensor.field.fill(c, B[components[c].a][components[c].b]);
    next.copy_from(phase.tensor.field);
    const Layout &layout = domain.layout();
    for (int c = 0; c < domain.dimension(); ++c)
      for (int k = -layout.ghosts[2]; k < layout.cells[2] + layout.ghosts[2]; ++k)
        for (int j = -layout.ghosts[1]; j < layout.cells[1] + layout.ghosts[1]; ++j)
          for (int i = -layout.ghosts[0]; i < layout.cells[0] + layout.ghosts[0]; ++i)
            velocity[c](i, j, k) = v(c, Real3{position(domain, 0, c == 0, i), position(domain, 1, c == 1, j),
                                              position(domain, 2, c == 2, k)});
    EXPECT_EQ(find_solid(domain, phase), 0);
  }

  void run(double end, int steps) {
    GhostExchange exchange(domain);
    const double dt = end / steps;
    for (int n = 0; n < steps; ++n) {
      ASSERT_EQ(transport_tensor(domain, {dt, false}, velocity, phase, phase.tensor.field, next), 0);
      ASSERT_EQ(exchange.update_ghosts(next, Box::stencil_width), 0);
      ASSERT_EQ(transport_tensor(domain, {dt, true}, velocity, phase, next, phase.tensor.field), 0);
      ASSERT_EQ(exchange.update_ghosts(phase.tensor.field, Box::stencil_width), 0);
    }
  }

  /// Largest difference from a uniform B.
  double error(const Matrix &exact) const {
    const auto &components = tensor_components(domain.dimension());
    double largest = 0;
    for (int c = 0; c < phase.tensor.field.count(); ++c)
      for_points(domain, phase.tensor.field[c], components[c].at, [&](double value, double, double, double) {
        largest = std::max(largest, std::fabs(value - exact[components[c].a][components[c].b]));
      });
    return largest;
  }
};

Matrix product(const Matrix &a, const Matrix &b, bool transposed) {
  Matrix c{};
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      for (int k = 0; k < 3; ++k) c[i][j] += a[i][k] * (transposed ? b[j][k] : b[k][j]);
  return c;
}

auto linear(const Matrix &L) {
  return [L](int c, const Real3 &x) { return L[c][0] * x[0] + L[c][1] * x[1] + L[c][2] * x[2]; };
}

const Int3 boxes[] = {{8, 8, 1}, {8, 8, 8}};

TEST(Kinematics, SimpleShearIsExact) {
  for (const Int3 &cells : boxes) {
    Kinematics flow(cells, identity, linear({{{0, 2, 0}, {0, 0, 0}, {0, 0, 0}}}));
    flow.run(0.5, 10);
    EXPECT_LT(flow.error({{{2, 1, 0}, {1, 1, 0}, {0, 0, 1}}}), 1e-13);
  }
}

TEST(Kinematics, RigidRotationOfTheUnstrainedMakesNoStrain) {
  for (const Int3 &cells : boxes) {
    const bool flat = cells[2] == 1;
    const double a = flat ? 0 : 0.3, b = flat ? 0 : -0.8, c = 1.1;
    Kinematics flow(cells, identity, linear({{{0, -c, b}, {c, 0, -a}, {-b, a, 0}}}));
    flow.run(2.0, 40);
    EXPECT_LT(flow.error(identity), 1e-13);
  }
}

double extension_error(const Int3 &cells, int steps) {
  Kinematics flow(cells, identity, linear({{{1, 0, 0}, {0, -1, 0}, {0, 0, 0}}}));
  flow.run(0.5, steps);
  return flow.error({{{std::exp(1.0), 0, 0}, {0, std::exp(-1.0), 0}, {0, 0, 1}}});
}

double rotation_error(const Int3 &cells, int steps) {
  const double w = 1.5, s = std::sin(w), c = std::cos(w);
  const Matrix R{{{c, -s, 0}, {s, c, 0}, {0, 0, 1}}};
  Matrix B{{{1.5, 0.3, 0}, {0.3, 0.8, 0}, {0, 0, 1}}};
  if (cells[2] > 1) B[0][2] = B[2][0] = 0.2, B[1][2] = B[2][1] = -0.1;
  Kinematics flow(cells, B, linear({{{0, -w, 0}, {w, 0, 0}, {0, 0, 0}}}));
  flow.run(1.0, steps);
  return flow.error(product(product(R, B, false), R, true));
}

TEST(Kinematics, ExtensionAndRotationAreSecondOrderInTime) {
  for (const Int3 &cells : boxes)
    for (const auto error : {extension_error, rotation_error}) {
      const double e[2] = {error(cells, 40), error(cells, 80)};
      std::printf("  S5 %.3e %.3e, order %.2f\n", e[0], e[1], order(e[0], e[1]));
      EXPECT_GT(order(e[0], e[1]), 1.9);
      EXPECT_LT(e[1], 1e-3);
    }
}

// B_xx(1/2, 1/2) = e^{4 pi t}; cells are odd, so that this is a centre.
double taylor_green_error(int cells) {
  Kinematics flow({cells, cells, 1}, identity, [](int c, const Real3 &x) {
    return c == 0 ? std::sin(2 * pi * x[0]) * std::cos(2 * pi * x[1])
                  : -std::cos(2 * pi * x[0]) * std::sin(2 * pi * x[1]);
  });
  constexpr double end = 0.05;
  flow.run(end, cells);
  return std::fabs(flow.phase.tensor.field[0](cells / 2, cells / 2, 0) / std::exp(4 * pi * end) - 1);
}

TEST(Kinematics, TaylorGreenCellStretchesExponentially) {
  const double e[2] = {taylor_green_error(33), taylor_green_error(65)};
  std::printf("  S5 Taylor-Green at 33, 65: %.3e %.3e, order %.2f\n", e[0], e[1], order(e[0], e[1]));
  EXPECT_GT(order(e[0], e[1]), 1.8);
  EXPECT_LT(e[1], 2e-3);
}

}  // namespace
