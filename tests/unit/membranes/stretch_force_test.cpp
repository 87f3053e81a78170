// -NAME_stretch_force: opposite forces on the two ends of a body at any position.
#include "membranes/stretch_force.hpp"
#include "support/interface_scene.hpp"

#include <gtest/gtest.h>

using namespace eulastic;
using namespace eulastic::test;

namespace {

constexpr int cells = 40;
constexpr double radius = 0.33, force = 0.7, part = 0.1;

// A ball or disc in a periodic box whose centre has this x.
struct Pulled : InterfaceScene {
  std::unique_ptr<Flow> flow;
  std::unique_ptr<StretchForces> forces;
  int dim;
  Real3 centre;

  Pulled(int dimension, double x) : dim(dimension), centre{x, 0.493, dimension == 2 ? 0 : 0.505} {
    GridSpec spec;
    spec.cells = {cells, cells, dim == 2 ? 1 : cells};
    spec.length = {1, 1, dim == 2 ? 1. / cells : 1};
    EXPECT_EQ(create(PETSC_COMM_SELF, spec), 0);
    set_fraction(ball(centre, radius, dim, true));
    flow = std::make_unique<Flow>(domain, SolverSpec{});
    forces = std::make_unique<StretchForces>(flow.get());
    EXPECT_EQ(flow->work.reserve(StretchForces::fields), 0);
    flow->now.phases.resize(1);
    Phase &phase = flow->now.phases[0];
    phase.fraction = std::move(fraction);
    phase.label = Field(domain, 1);
    phase.material.stretch_force = {force, part};
    each_owned([&](int i, int j, int k) { phase.label[0](i, j, k) = phase.fraction[0](i, j, k) > 1e-12; });
    EXPECT_EQ(flow->exchange.update_ghosts(phase.fraction, 1), 0);
    EXPECT_EQ(phase.rows.find(domain, phase.fraction[0]), 0);
    flow->bodies.add_phase(domain, {{{std::fmod(x, 1.0), centre[1], centre[2]}, {}}});
  }
  // The forces as added to a rate.
  Field rate(double scale) {
    Field rate(domain, dim);
    const MomentumStep any_step{};
    EXPECT_EQ(forces->add_rate({any_step, scale, rate, nullptr, {}, 0}), 0);
    return rate;
  }
  /// Position of a face or a cell relative to the centre.
  double x_of(int i, bool cell) const {
    const double x = position({i, 0, 0}, {cell, true, true})[0] - centre[0];
    return x - std::round(x);
  }
};

// Volume and mean x of the part of a ball or disc beyond t.
std::pair<double, double> cap(int dim, double t) {
  const double R = radius, s = R * R - t * t;
  if (dim == 2) {
    const double area = R * R * std::acos(t / R) - t * std::sqrt(s);
    return {area, 2. / 3 * s * std::sqrt(s) / area};
  }
  const double volume = M_PI * (R - t) * (R - t) * (2 * R + t) / 3;
  return {volume, M_PI / 4 * s * s / volume};
}

TEST(StretchForce, PullsThatPartOfTheVolumeAtEitherEnd) {
  for (const int dim : {2, 3}) {
    const double whole = dim == 2 ? M_PI * radius * radius : 4. / 3 * M_PI * std::pow(radius, 3);
    double low = 0, high = radius;
    for (int n = 0; n < 60; ++n) (cap(dim, 0.5 * (low + high)).first > part * whole ? low : high) = 0.5 * (low + high);
    const double middle = cap(dim, low).second;
    for (const double x : {0.51, 0.03}) {
      Pulled body(dim, x);
      constexpr double scale = 0.5;
      const Field rate = body.rate(scale);
      const double volume = body.domain.cell_volume();
      double all = 0, sum[2] = {}, place[2] = {}, largest = 0;
      body.each_owned([&](int i, int j, int k) {
        const double f = rate[0](i, j, k) * volume / (scale * force), at = body.x_of(i, false);
        all += f;
        sum[at > 0] += f;
        place[at > 0] += f * at;
        largest = std::max(largest, std::fabs(f) / volume);
        for (int d = 1; d < dim; ++d) EXPECT_EQ(rate[d](i, j, k), 0);
      });
      EXPECT_NEAR(all, 0, 1e-12);
      EXPECT_NEAR(sum[1], 1, 1e-12);
      EXPECT_NEAR(sum[0], -1, 1e-12);
      EXPECT_NEAR(largest * part * whole, 1, 0.01);
      for (const double found : place) EXPECT_NEAR(found, middle, 0.01 * radius);
    }
  }
}

// The force is continuous when the body moves by a hundredth of a cell.
TEST(StretchForce, FollowsTheBodyContinuously) {
  constexpr double step = 0.01 / cells;
  double before = 0, most = 0, travelled = 0;
  for (int n = 0; n <= 20; ++n) {
    Pulled body(2, 0.51 + 5 * n * step);
    const Field rate = body.rate(1);
    double moment = 0;
    body.each_owned([&](int i, int j, int k) {
      if (const double at = body.x_of(i, false); at > 0)
        moment += rate[0](i, j, k) * body.domain.cell_volume() * (at + body.centre[0]);
    });
    if (n > 0) {
      most = std::max(most, std::fabs(moment - before));
      travelled += moment - before;
    }
    before = moment;
  }
  EXPECT_NEAR(travelled, force * 100 * step, 0.03 * force * 100 * step);
  EXPECT_LT(most, 2 * force * 5 * step);
}

TEST(StretchForce, PowerIsThatOfTheEnds) {
  for (const int dim : {2, 3}) {
    Pulled body(dim, 0.51);
    constexpr double rate = 0.4;
    for (int k = 0; k < body.domain.cells()[2]; ++k)
      for (int j = 0; j < cells; ++j)
        for (int i = 0; i <= cells; ++i) body.velocity[0](i, j, k) = 3 + rate * i / cells;
    body.flow->now.velocity = std::move(body.velocity);
    const Field &velocity = body.flow->now.velocity, force_rate = body.rate(1);
    double expected = 0, power = 0;
    body.each_owned([&](int i, int j, int k) {
      expected += force_rate[0](i, j, k) * velocity[0](i, j, k) * body.domain.cell_volume();
    });
    ASSERT_EQ(body.forces->add_power({body.flow->now.phases, {}}, &power), 0);
    EXPECT_NEAR(power, expected, 1e-12);
    EXPECT_GT(power, rate * force * radius);
  }
}

}  // namespace
