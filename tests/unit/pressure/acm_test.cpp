// (12) against a search for the minimum, its guards, and the divergence after one step of the solver.
#include "pressure/acm.hpp"
#include "flow/projection.hpp"

#include "flow/correction.hpp"
#include "support/polynomials.hpp"
#include "support/verbs.hpp"

#include <gtest/gtest.h>

using namespace eulastic;
using namespace eulastic::test;

namespace {

// Fields on a periodic line of a few points; J = <(D + kappa lap D + g lap p)^2>.
struct Line {
  std::vector<double> D, p, lap_D, lap_p;

  explicit Line(Random &random, double share = 0) {
    for (int i = 0; i < 7; ++i) {
      D.push_back(random());
      p.push_back(share * D.back() + (1 - std::fabs(share)) * random());
    }
    for (int i = 0; i < 7; ++i) {
      lap_D.push_back(D[(i + 1) % 7] + D[(i + 6) % 7] - 2 * D[i]);
      lap_p.push_back(p[(i + 1) % 7] + p[(i + 6) % 7] - 2 * p[i]);
    }
  }
  double J(double kappa, double g) const {
    double sum = 0;
    for (int i = 0; i < 7; ++i) sum += std::pow(D[i] + kappa * lap_D[i] + g * lap_p[i], 2);
    return sum;
  }
  AcmSums sums() const {
    AcmSums s{};
    for (int i = 0; i < 7; ++i) {
      s.A1 -= D[i] * lap_D[i];
      s.A2 += lap_D[i] * lap_D[i];
      s.A3 += lap_p[i] * lap_p[i];
      s.B1 += D[i] * lap_p[i];
      s.B2 += lap_D[i] * lap_p[i];
    }
    return s;
  }
};

// The least J for kappa in [low, high] at every g of a grid that is refined around the best value.
std::array<double, 2> search(const Line &line, double g_least) {
  std::array<double, 2> best{0, std::max(0.0, g_least)};
  double step = 0.5;
  for (int round = 0; round < 60; ++round) {
    bool moved = true;
    while (moved) {
      moved = false;
      for (int a = -1; a <= 1; ++a)
        for (int b = -1; b <= 1; ++b) {
          const std::array<double, 2> trial{best[0] + a * step, std::max(g_least, best[1] + b * step)};
          if (line.J(trial[0], trial[1]) < line.J(best[0], best[1])) {
            best = trial;
            moved = true;
          }
        }
    }
    step *= 0.6;
  }
  return best;
}

TEST(AcmCoefficients, AreTheBruteForceMinimum) {
  Random random(1);
  int both = 0, only_kappa = 0;
  for (int n = 0; n < 200; ++n) {
    const Line line(random, n % 2 ? 0.5 : -0.5);
    const AcmCoefficients c = acm_coefficients(line.sums());
    const auto free = search(line, -1e3);
    if (free[0] > 1e-6 && free[1] > 1e-6) {
      EXPECT_NEAR(c.kappa, free[0], 1e-6);
      EXPECT_NEAR(c.g, free[1], 1e-6);
      ++both;
    } else if (free[0] < -1e-6 || free[1] < -1e-6) {
      EXPECT_EQ(c.g, 0);
      const double d = 1e-3;
      EXPECT_LT(line.J(c.kappa, 0), line.J(c.kappa + d, 0));
      EXPECT_LT(line.J(c.kappa, 0), line.J(c.kappa - d, 0));
      if (free[0] > 0) {
        EXPECT_NEAR(c.kappa, search(line, 0)[0], 1e-6) << "least with g >= 0";
      }
      ++only_kappa;
    }
    EXPECT_LT(line.J(c.kappa, c.g), line.J(0, 0));
  }
  EXPECT_GT(both, 30);
  EXPECT_GT(only_kappa, 30);
}

TEST(AcmCoefficients, SoundSpeedAndRelaxation) {  // kappa = beta^2 dt^2, g = kappa gamma
  const AcmCoefficients c{0.36, 0.09};
  EXPECT_NEAR(c.sound_speed(0.2), 3, 1e-14);
  EXPECT_NEAR(c.relaxation(), 0.25, 1e-15);
  EXPECT_EQ(AcmCoefficients{}.relaxation(), 0);
  EXPECT_EQ(AcmCoefficients{}.sound_speed(0.2), 0);
}

TEST(AcmGuards, HandValues) {  // kappa = (A1 A3 + B1 B2)/det, g = -(B1 A2 + A1 B2)/det, det = A2 A3 - B2^2
  const AcmCoefficients c = acm_coefficients({3, 4, 2, -1, 1});
  EXPECT_NEAR(c.kappa, 5. / 7, 1e-15);
  EXPECT_NEAR(c.g, 1. / 7, 1e-15);
}

void expect_only_kappa(const AcmSums &sums) {
  const AcmCoefficients c = acm_coefficients(sums);
  EXPECT_EQ(c.kappa, sums.A1 / sums.A2);
  EXPECT_EQ(c.g, 0);
}

TEST(AcmGuards, NegativeKappa) { expect_only_kappa({1, 4, 2, -3, 1}); }  // 2 - 3 < 0, while g = 11 > 0
TEST(AcmGuards, NegativeRelaxation) { expect_only_kappa({3, 4, 2, 1, 1}); }
TEST(AcmGuards, NoPressure) { expect_only_kappa({3, 4, 0, 0, 0}); }

TEST(AcmGuards, ParallelFields) {
  Random random(2);
  for (const double factor : {-2.0, 0.1, 1.0, 3e5}) {
    Line line(random);
    for (int i = 0; i < 7; ++i) {
      line.p[i] = factor * line.D[i];
      line.lap_p[i] = factor * line.lap_D[i];
    }
    expect_only_kappa(line.sums());
    for (int i = 0; i < 7; ++i) line.lap_p[i] *= 1 + 1e-9 * random();  // nearly so
    expect_only_kappa(line.sums());
  }
}

TEST(AcmGuards, NothingToDo) {
  for (const AcmSums &sums : {AcmSums{0, 0, 0, 0, 0}, AcmSums{0, 0, 5, 0, 0}, AcmSums{1, 0, 5, 1, 1}}) {
    const AcmCoefficients c = acm_coefficients(sums);
    EXPECT_EQ(c.kappa, 0);
    EXPECT_EQ(c.g, 0);
  }
}

struct CellBlock {
  bool flat;
  int walls;
  double pressure;  // size of p^N
};

class AcmStep : public ::testing::TestWithParam<CellBlock> {};

// From a random v*, the divergence of the new velocity is as (12) predicts, and the new pressure has no mean.
TEST_P(AcmStep, ReachesThePredictedResidual) {
  GridSpec spec = uneven_box(GetParam().flat, {18, 9, 7});
  for (int d = 0; d < 3; ++d)
    if (GetParam().walls >> d & 1) spec.boundary[d] = Boundary::wall;
  Domain domain;
  ASSERT_EQ(domain.create(PETSC_COMM_SELF, spec), 0);
  GhostExchange exchange(domain);
  const BoundaryConditions walls{};
  Random random(3);
  const double dt = 0.02, density = 1.7;
  Field velocity(domain, domain.dimension()), D(domain, 1), p(domain, 1), none;
  const auto velocity_ghosts = [&](Field &v) {
    EXPECT_EQ(exchange.update_ghosts(v, 1), 0);
    fill_wall_ghosts_velocity(domain, walls, 0, v, 1);
  };
  const auto centre_ghosts = [&](Field &q) {
    EXPECT_EQ(exchange.update_ghosts(q, 1), 0);
    fill_wall_ghosts_even(domain, at_centre, q[0], 1);
  };
  const auto sum = [&](const Field &a, const Field &b) {
    double total = 0;
    for (const Segment &s : domain.rows())
      for (int i = 0; i < s.i_end; ++i) total += a[0](i, s.j, s.k) * b[0](i, s.j, s.k);
    return total;
  };
  for (int a = 0; a < domain.dimension(); ++a)
    set(domain, velocity[a], at_face[a], [&](double, double, double) { return random(); });
  set(domain, p[0], at_centre, [&](double, double, double) { return GetParam().pressure * (3 + random()); });
  velocity_ghosts(velocity);
  centre_ghosts(p);
  ASSERT_EQ(compute_divergence(domain, density, velocity, D), 0);
  centre_ghosts(D);
  // D + kappa lap D + g lap p with the coefficients that the solver reports.
  Field predicted(domain, 1), lap_D(domain, 1), lap_p(domain, 1);
  double second[3];
  for (int d = 0; d < 3; ++d) second[d] = 1 / (domain.spacing()[d] * domain.spacing()[d]);
  const auto laplacian = [&](const Field &q, Field &out) {
    const ConstView view = q[0];
    for (const Segment &s : domain.rows())
      for (int i = 0; i < s.i_end; ++i) {
        double total = 0;
        for (int d = 0; d < domain.dimension(); ++d) {
          const double *c = view.row(s.j, s.k) + i;
          total += second[d] * (c[view.stride(d)] - 2 * c[0] + c[-view.stride(d)]);
        }
        out[0](i, s.j, s.k) = total;
      }
  };
  laplacian(D, lap_D);
  laplacian(p, lap_p);

  AcmSolver solver(domain);
  Field old_pressure(domain, 1);
  std::copy(p.data(), p.data() + p.layout().size, old_pressure.data());
  ASSERT_EQ(solver.solve(dt, D, p, none), 0);
  const auto [kappa, g] = solver.last();
  EXPECT_GT(kappa, 0);
  ASSERT_EQ(correct_velocity(domain, density, dt, 0, *solver.formula(), D, velocity, p), 0);
  velocity_ghosts(velocity);
  Field D_new(domain, 1);
  ASSERT_EQ(compute_divergence(domain, density, velocity, D_new), 0);

  const AcmSums s{-sum(D, lap_D), sum(lap_D, lap_D), sum(lap_p, lap_p), sum(D, lap_p), sum(lap_D, lap_p)};
  const double before = sum(D, D), least = before - kappa * s.A1 + g * s.B1;
  EXPECT_NEAR(sum(D_new, D_new), least, 1e-11 * before);
  EXPECT_LT(least, 0.9 * before);
  if (g > 0) {  // the minimum: the new divergence is orthogonal to both directions
    EXPECT_NEAR(sum(D_new, lap_p), 0, 1e-10 * std::sqrt(before * s.A3));
  }
  EXPECT_NEAR(sum(D_new, lap_D), 0, 1e-10 * std::sqrt(before * s.A2));

  double mean = 0;
  for (const Segment &row : domain.rows())
    for (int i = 0; i < row.i_end; ++i) mean += p[0](i, row.j, row.k) / domain.domain_cell_count();
  EXPECT_NEAR(mean, 0, 1e-12 * (1 + GetParam().pressure));

  // The ghosts are right without an exchange.
  Field fresh(domain, 1);
  std::copy(p.data(), p.data() + p.layout().size, fresh.data());
  centre_ghosts(fresh);
  const Int3 n = domain.cells();
  for (int j = -1; j <= n[1]; ++j)
    for (int i = -1; i <= n[0]; ++i) EXPECT_EQ(p[0](i, j, 0), fresh[0](i, j, 0));
}

INSTANTIATE_TEST_SUITE_P(Boxes, AcmStep,
                         ::testing::Values(CellBlock{false, 2, 50}, CellBlock{false, 0, 1}, CellBlock{false, 7, 50},
                                           CellBlock{false, 2, 0}, CellBlock{true, 2, 50}, CellBlock{true, 3, 50},
                                           CellBlock{true, 0, 0}));

}  // namespace
