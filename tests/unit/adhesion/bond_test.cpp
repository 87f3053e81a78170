// Chance and kinetics of single bonds.
#include "kernels/bond.hpp"
#include "base/philox.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace eulastic {
namespace {

using kernels::BondLaw;
using kernels::probability;

// The known answers that come with Random123 (Salmon et al., SC 2011).
TEST(Philox, KnownAnswers) {
  EXPECT_EQ(philox({0, 0, 0, 0}, {0, 0}), (PhiloxCounter{0x6627e8d5, 0xe169c58d, 0xbc57ac4c, 0x9b00dbd8}));
  EXPECT_EQ(philox({~0u, ~0u, ~0u, ~0u}, {~0u, ~0u}), (PhiloxCounter{0x408f276d, 0x41c83b0e, 0xa20bc7c6, 0x6d5451fd}));
  EXPECT_EQ(philox({0x243f6a88, 0x85a308d3, 0x13198a2e, 0x03707344}, {0xa4093822, 0x299f31d0}),
            (PhiloxCounter{0xd16cfe09, 0x94fdcceb, 0x5001e420, 0x24126ea1}));
}

TEST(Philox, UniformNumbersFillTheUnitInterval) {
  constexpr int count = 100000;
  double sum = 0, squares = 0;
  for (unsigned n = 0; n < count; ++n) {
    const double u = uniform(philox({n, 0, 0, 0}, {7, 0}));
    ASSERT_GE(u, 0);
    ASSERT_LT(u, 1);
    sum += u;
    squares += u * u;
  }
  EXPECT_NEAR(sum / count, 0.5, 4 * std::sqrt(1. / 12 / count));
  EXPECT_NEAR(squares / count, 1. / 3, 4 * std::sqrt(4. / 45 / count));
  EXPECT_EQ(uniform({~0u, ~0u, 0, 0}), 1 - 0x1p-53);
  EXPECT_EQ(uniform({0, 0, 0, 0}), 0);
}

// A slip bond, and one whose life is longest at a tension between.
BondLaw slip() {
  BondLaw law;
  law.rate_off = 0.5;
  law.reactive_compliance = 0.8;
  return law;
}
BondLaw catch_and_slip() {
  BondLaw law = slip();
  law.rate_off = 0.02;
  law.catch_rate_off = 5;
  law.catch_compliance = 2;
  return law;
}

// 1000 bonds at a constant tension, step by step: exponential lifetimes with the mean of the rate, by the test of
// Kolmogorov and Smirnov at one per mille and within four standard errors.
TEST(Bond, LifetimesAtConstantTension) {
  constexpr int bonds = 1000;
  unsigned key = 0;
  for (const BondLaw &law : {slip(), catch_and_slip()})
    for (const double tension : {0., 1., 2.5}) {
      const double rate = law.off_rate(tension), dt = 0.02 / rate;
      std::vector<double> lives;
      ++key;
      for (unsigned b = 0; b < bonds; ++b)
        for (unsigned step = 1;; ++step)
          if (uniform(philox({b, step, 0, 0}, {key, 0})) < probability(rate, dt)) {
            lives.push_back(step * dt);
            break;
          }
      std::sort(lives.begin(), lives.end());
      double sum = 0, distance = 0;
      for (int b = 0; b < bonds; ++b) {
        sum += lives[b];
        // The distribution of steps, at the end of the step before, and at the end of this one.
        distance = std::max({distance, (b + 1.) / bonds - probability(rate, lives[b]),
                             probability(rate, lives[b] - dt) - double(b) / bonds});
      }
      const double mean = dt / probability(rate, dt);
      EXPECT_NEAR(sum / bonds, mean, 4 * mean / std::sqrt(bonds)) << "tension " << tension;
      EXPECT_LT(distance, 1.95 / std::sqrt(bonds) + probability(rate, dt)) << "tension " << tension;
    }
}

TEST(Bond, RatesOfRupture) {
  const BondLaw bell = slip(), caught = catch_and_slip();
  EXPECT_DOUBLE_EQ(bell.off_rate(2), 0.5 * std::exp(1.6));
  EXPECT_EQ(bell.off_rate(-3), bell.off_rate(0)) << "pressing";
  EXPECT_DOUBLE_EQ(caught.off_rate(1), 0.02 * std::exp(0.8) + 5 * std::exp(-2.));
  EXPECT_LT(caught.off_rate(2), caught.off_rate(0));
  EXPECT_LT(caught.off_rate(2), caught.off_rate(8));
}

// Sites that are free or bound: as many bonds as the rates say.
TEST(Bond, NumberInEquilibrium) {
  constexpr unsigned sites = 4000, steps = 400;
  BondLaw law = slip();
  law.rate_on = 1.5;
  law.reach = 1;
  const double dt = 0.02, share = law.rate_on / (law.rate_on + law.off_rate(0));
  std::vector<char> bound(sites, 0);
  for (unsigned step = 0; step < steps; ++step)
    for (unsigned s = 0; s < sites; ++s) {
      const double rate = bound[s] ? law.off_rate(0) : law.on_rate(0);
      if (uniform(philox({s, step, 0, 0}, {3, 0})) < probability(rate, dt)) bound[s] = !bound[s];
    }
  const double found = double(std::count(bound.begin(), bound.end(), 1)) / sites;
  const double expected =
      probability(law.rate_on, dt) / (probability(law.rate_on, dt) + probability(law.off_rate(0), dt));
  EXPECT_NEAR(expected, share, 0.01);
  EXPECT_NEAR(found, expected, 4 * std::sqrt(expected * (1 - expected) / sites));
}

TEST(Bond, DetailedBalance) {
  BondLaw law = catch_and_slip();
  law.stiffness = 3;
  law.length = 0.4;
  law.reach = 2;
  law.rate_on = 0.7;
  law.thermal_energy = 0.25;
  const double at_rest = law.on_rate(law.length) / law.off_rate(0);
  EXPECT_DOUBLE_EQ(at_rest, 0.7 / law.off_rate(0));
  for (const double length : {0.1, 0.6, 1.3}) {
    const double ratio = law.on_rate(length) / law.off_rate(law.tension(length));
    EXPECT_NEAR(ratio / at_rest, std::exp(-law.energy(length) / law.thermal_energy), 1e-14) << length;
  }
  EXPECT_EQ(law.on_rate(2.1), 0) << "out of reach";
  law.thermal_energy = 0;
  EXPECT_EQ(law.on_rate(1.9), 0.7);
}

}  // namespace
}  // namespace eulastic
