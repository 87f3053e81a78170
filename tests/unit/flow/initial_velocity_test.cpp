// Initial velocities agree with their formulas, and are solenoidal to second order.
#include "flow/initial_velocity.hpp"

#include <gtest/gtest.h>

#include <cmath>

using namespace eulastic;

namespace {

constexpr double pi = 3.14159265358979323846;

struct Flow {
  Domain domain;
  Field velocity;
  Flow(const GridSpec &spec, const InitialFlow &flow, const BoundaryConditions &walls = {}) {
    EXPECT_EQ(domain.create(PETSC_COMM_SELF, spec), 0);
    velocity = Field(domain, domain.dimension());
    set_initial_velocity(domain, walls, flow, velocity);
  }
  double u(int c, int i, int j, int k) const { return velocity[c](i, j, k); }

  // Returns the largest |div v| over the cells, relative to the largest |v| / length; points with index N follow from
  // periodicity or are 0 on a wall.
  double divergence() const {
    const Int3 n = domain.domain_cells();
    double largest = 0, speed = 0;
    for (int k = 0; k < n[2]; ++k)
      for (int j = 0; j < n[1]; ++j)
        for (int i = 0; i < n[0]; ++i) {
          double sum = 0;
          for (int d = 0; d < domain.dimension(); ++d) {
            Int3 next{i, j, k};
            const bool last = ++next[d] == n[d];
            if (last) next[d] = 0;
            const double high = last && domain.is_wall(d) ? 0 : u(d, next[0], next[1], next[2]);
            sum += (high - u(d, i, j, k)) / domain.spacing()[d];
            speed = std::max(speed, std::fabs(u(d, i, j, k)));
          }
          largest = std::max(largest, std::fabs(sum));
        }
    return largest / speed;
  }
};

GridSpec box(Int3 cells, Real3 length, std::array<Boundary, 3> boundary = {}) {
  GridSpec spec;
  spec.cells = cells;
  spec.length = length;
  spec.boundary = boundary;
  return spec;
}

}  // namespace

TEST(InitialVelocity, NamesMatchTheEnum) {
  ASSERT_EQ(initial_velocity_names().size(), static_cast<std::size_t>(InitialVelocity::random) + 1);
  EXPECT_EQ(initial_velocity_names()[static_cast<int>(InitialVelocity::couette)], "couette");
  EXPECT_EQ(initial_velocity_names()[static_cast<int>(InitialVelocity::random)], "random");
  EXPECT_EQ(shear_wave_directions(InitialVelocity::shear_wave_zx), (std::array<int, 2>{2, 0}));
  EXPECT_EQ(shear_wave_directions(InitialVelocity::zero), (std::array<int, 2>{-1, -1}));
}

TEST(InitialVelocity, TaylorGreen) {
  const Flow flow(box({8, 12, 1}, {2, 3, 1}), {InitialVelocity::taylor_green, 1.5, {0.5, -1, 0}});
  EXPECT_NEAR(flow.u(0, 3, 2, 0), 0.5 + 1.5 * std::sin(2 * pi * 3 / 8) * std::cos(2 * pi * 2.5 / 12), 1e-14);
  EXPECT_NEAR(flow.u(1, 3, 2, 0), -1 - 1.5 * 3 / 2 * std::cos(2 * pi * 3.5 / 8) * std::sin(2 * pi * 2 / 12), 1e-14);
  // Square cells in a square box: solenoidal to round-off.
  EXPECT_LT(Flow(box({16, 16, 1}, {1, 1, 1}), {InitialVelocity::taylor_green, 1, {1, 1, 0}}).divergence(), 1e-13);
  const InitialFlow solid{InitialVelocity::taylor_green_3d, 2, {}};
  EXPECT_LT(Flow(box({12, 12, 12}, {2, 2, 2}), solid).divergence(), 1e-13);
  EXPECT_NEAR(Flow(box({12, 12, 12}, {2, 2, 2}), solid).u(0, 3, 0, 0), 2 * std::pow(std::cos(2 * pi / 24), 2), 1e-14);
}

TEST(InitialVelocity, ShearLayer) {
  const Flow flow(box({8, 8, 1}, {1, 1, 1}), {InitialVelocity::shear_layer, 1, {}});
  EXPECT_NEAR(flow.u(0, 5, 3, 0), std::tanh(30 * (3.5 / 8 - 0.25)), 1e-14);
  EXPECT_NEAR(flow.u(0, 5, 5, 0), std::tanh(30 * (0.75 - 5.5 / 8)), 1e-14);
  EXPECT_NEAR(flow.u(1, 2, 3, 0), 0.05 * std::sin(2 * pi * 2.5 / 8), 1e-14);
}

TEST(InitialVelocity, Channel) {
  const GridSpec channel = box({4, 5, 3}, {1, 2, 1}, {Boundary::periodic, Boundary::wall, Boundary::periodic});
  BoundaryConditions walls{};
  walls[1][0].motion.velocity = {-1, 0, 2};
  walls[1][1].motion.velocity = {3, 0, 4};
  const Flow couette(channel, {InitialVelocity::couette, 9, {}}, walls);
  EXPECT_NEAR(couette.u(0, 1, 1, 1), -1 + 4 * 0.3, 1e-14);
  EXPECT_NEAR(couette.u(2, 1, 1, 1), 2 + 2 * 0.3, 1e-14);
  EXPECT_EQ(couette.u(1, 1, 1, 1), 0);
  const Flow poiseuille(channel, {InitialVelocity::poiseuille, 2, {}});
  EXPECT_NEAR(poiseuille.u(0, 1, 2, 1), 2, 1e-14);
  EXPECT_NEAR(poiseuille.u(0, 1, 0, 1), 2 * 4 * 0.1 * 0.9, 1e-14);
}

TEST(InitialVelocity, ShearWaves) {
  for (int kind = static_cast<int>(InitialVelocity::shear_wave_xy);
       kind <= static_cast<int>(InitialVelocity::shear_wave_zy); ++kind) {
    const auto [a, b] = shear_wave_directions(static_cast<InitialVelocity>(kind));
    for (Boundary boundary : {Boundary::periodic, Boundary::wall}) {
      GridSpec spec = box({6, 6, 6}, {1, 2, 3});
      spec.boundary[b] = boundary;
      const Flow flow(spec, {static_cast<InitialVelocity>(kind), 1.5, {}});
      const double waves = boundary == Boundary::wall ? 1 : 2;
      Int3 cell{2, 2, 2};
      cell[b] = 4;
      for (int c = 0; c < 3; ++c)
        EXPECT_NEAR(flow.u(c, cell[0], cell[1], cell[2]), c == a ? 1.5 * std::sin(waves * pi * 4.5 / 6) : 0, 1e-14);
    }
  }
}

TEST(InitialVelocity, RandomIsSolenoidalInEveryBox) {
  for (int walls = 0; walls < 8; ++walls)
    for (int flat = 0; flat < 2; ++flat) {
      std::array<Boundary, 3> boundary{};
      for (int d = 0; d < 3; ++d)
        if (walls >> d & 1) boundary[d] = Boundary::wall;
      if (flat && boundary[2] == Boundary::wall) continue;
      const auto divergence = [&](int n) {
        const Flow flow(box({n, n, flat ? 1 : n}, {1, 1.3, 0.8}, boundary), {InitialVelocity::random, 1, {}});
        return flow.divergence();
      };
      const double coarse = divergence(20), fine = divergence(40);
      EXPECT_GT(coarse, 1e-6);
      EXPECT_GT(coarse / fine, 3.3) << "walls " << walls << ": " << coarse << " " << fine;
    }
}
