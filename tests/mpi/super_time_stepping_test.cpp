// RKL2 on eigenmodes of the discrete Laplacian: the stages of a number, as Meyer, Balsara & Aslam (2014) write them.
#include "flow/super_time_stepping.hpp"
#include "base/rank_zero.hpp"
#include "support/all_segments.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace eulastic {
namespace {

constexpr double pi = 3.14159265358979323846;

// y(dt) of y' = eigenvalue y + first + t slope from y(0) = 0, in Y of (their) (16).
double stages_of_a_number(int s, double dt, double eigenvalue, double first, double slope) {
  const auto b = [](int j) { return j < 2 ? 1. / 3 : (j * j + j - 2.) / (2. * j * (j + 1)); };
  const auto rate = [&](double share, double y) { return eigenvalue * y + first + share * dt * slope; };
  const double w = s * s + s - 2.;
  double before = 0, now = 4 / (3 * w) * dt * rate(0, 0);
  for (int j = 2; j <= s; ++j) {
    const double mu = (2. * j - 1) / j * b(j) / b(j - 1), nu = -(j - 1.) / j * b(j) / b(j - 2), mu_tilde = 4 / w * mu;
    const double reached = j == 2 ? 4 / (3 * w) : ((j - 1.) * (j - 1) + (j - 1) - 2) / w;
    const double next =
        mu * now + nu * before + mu_tilde * dt * rate(reached, now) - (1 - b(j - 1)) * mu_tilde * dt * rate(0, 0);
    before = now;
    now = next;
  }
  return now;
}

// One factor of a mode along direction d at index i (global), and its eigenvalue.
struct Wave {
  int cells, number;
  double spacing;
  bool wall, on_face;

  double operator()(int i) const {
    if (wall) return std::sin(pi * number * (on_face ? i : i + 0.5) / cells);
    return std::cos(2 * pi * number * i / cells + 0.3);
  }
  double eigenvalue() const {
    const double s = std::sin(pi * number / (wall ? 2. * cells : cells));
    return -4 * s * s / (spacing * spacing);
  }
};

// So many rows that a block of them begins for the last stages alone; four stages to a pass or, in few planes, two.
class EigenModes : public testing::TestWithParam<std::tuple<Boundary, int, int>> {};

TEST_P(EigenModes, GoThroughTheStagesOfANumber) {
  const auto [boundary, stages, planes] = GetParam();
  GridSpec spec;
  spec.cells = {16, boundary == Boundary::wall ? 63 : 60, planes};
  spec.length = {1.6, 6, planes * 0.1};
  spec.boundary = {Boundary::periodic, boundary, Boundary::periodic};
  Domain domain;
  ASSERT_EQ(domain.create(run_communicator(), spec), 0);
  GhostExchange exchange(domain);
  const double viscosity = 0.7, dt = 0.02, first = 1.3, slope = -40, start = 0.25;
  SuperTimeStepping work{Field(domain, 3), Field(domain, 3), Field(domain, 3), Field(domain, 3)};
  Field velocity(domain, 3), result(domain, 3);
  std::vector<Phase> phases(1);
  build_all(domain, &phases[0].tensor.stressed);
  std::array<std::array<Wave, 3>, 3> waves;
  const auto mode = [&](int c, const Segment &row, int i) {
    const Int3 &begin = domain.layout().begin;
    return waves[c][0](begin[0] + i) * waves[c][1](begin[1] + row.j) * waves[c][2](begin[2] + row.k);
  };
  for (int c = 0; c < 3; ++c)
    for (int d = 0; d < 3; ++d)
      waves[c][d] = {spec.cells[d], 1 + (c + d) % 3, domain.spacing()[d], domain.is_wall(d), c == d};
  for (int c = 0; c < 3; ++c)
    for (const Segment &row : domain.rows())
      for (int i = row.i_begin; i < row.i_end; ++i) {
        velocity[c](i, row.j, row.k) = start * mode(c, row, i);
        work.rate[c](i, row.j, row.k) = first * mode(c, row, i);
        work.slope[c](i, row.j, row.k) = slope * mode(c, row, i);
      }
  const BoundaryConditions sides{};
  const ViscousStep step{sides, 0, dt, stages, velocity, viscosity, nullptr, stressed_rows(domain, phases)};
  ASSERT_EQ(super_time_step(domain, exchange, step, work, result), 0);
  for (int c = 0; c < 3; ++c) {
    double eigenvalue = 0;
    for (const Wave &wave : waves[c]) eigenvalue += viscosity * wave.eigenvalue();
    const double grown = start + stages_of_a_number(stages, dt, eigenvalue, first - 0.5 * dt * slope, slope);
    double worst = 0;
    for (const Segment &row : domain.rows()) {
      if (c == 1 && row.j == 0 && domain.touches_low(1)) continue;  // on the wall: whoever fills its ghosts sets these
      for (int i = row.i_begin; i < row.i_end; ++i)
        worst = std::max(worst, std::abs(result[c](i, row.j, row.k) - grown * mode(c, row, i)));
    }
    EXPECT_LT(worst, 1e-14) << "component " << c;
  }
}

INSTANTIATE_TEST_SUITE_P(SuperTimeStepping, EigenModes,
                         testing::Combine(testing::Values(Boundary::periodic, Boundary::wall), testing::Values(3, 5, 9),
                                          testing::Values(6, 48)));

}  // namespace
}  // namespace eulastic
