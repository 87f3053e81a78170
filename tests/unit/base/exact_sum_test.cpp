// The superaccumulator is compared with hand-written values and with Shewchuk's exact expansions; lane sums; blocks of
// a row.
#include "base/exact_sum.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <numeric>
#include <random>

namespace eulastic {
namespace {

using Limits = std::numeric_limits<double>;
constexpr double largest = Limits::max(), smallest = Limits::denorm_min(), inf = Limits::infinity();

double exact(const std::vector<double> &terms) {
  Superaccumulator sum;
  for (const double term : terms) sum.add(term);
  return sum.value();
}

std::uint64_t bits(double value) {
  std::uint64_t word;
  std::memcpy(&word, &value, sizeof word);
  return word;
}

// Returns the correctly rounded sum by non-overlapping partial sums (Shewchuk 1997, as in Python's math.fsum), for
// terms that do not overflow.
double shewchuk(const std::vector<double> &terms) {
  std::vector<double> parts;
  for (double x : terms) {
    std::size_t kept = 0;
    for (double y : parts) {
      if (std::abs(x) < std::abs(y)) std::swap(x, y);
      const double high = x + y, low = y - (high - x);
      if (low != 0) parts[kept++] = low;
      x = high;
    }
    parts.resize(kept);
    parts.push_back(x);
  }
  double high = 0, low = 0;
  while (!parts.empty() && low == 0) {
    const double x = high, y = parts.back();
    parts.pop_back();
    high = x + y;
    low = y - (high - x);
  }
  // A tie is broken by the sign of the next partial sum.
  if (!parts.empty() && ((low < 0 && parts.back() < 0) || (low > 0 && parts.back() > 0))) {
    const double twice = 2 * low, next = high + twice;
    if (twice == next - high) high = next;
  }
  return high;
}

TEST(Superaccumulator, HandValues) {
  EXPECT_EQ(bits(exact({})), bits(0.0));
  EXPECT_EQ(bits(exact({-0.0, -0.0})), bits(0.0));
  EXPECT_EQ(exact({1e300, 1, -1e300}), 1);
  EXPECT_EQ(exact({1, 1e100, 1, -1e100}), 2);
  EXPECT_EQ(exact({-1e300, -1, 1e300}), -1);
  EXPECT_EQ(exact({1e300, smallest, -1e300}), smallest);
  EXPECT_EQ(exact({.1, .2, -.3}), 0x1p-55);  // of the doubles nearest to 0.1, 0.2 and 0.3
  EXPECT_EQ(exact({-2.5}), -2.5);
  EXPECT_EQ(exact({-1, 0x1p-60}), -1);
  EXPECT_EQ(exact({-1, 0x1p-54}), -1);              // half-way: to even
  EXPECT_EQ(exact({-1, 0x1.8p-54}), -1 + 0x1p-53);  // beyond half-way
  for (int e = -1074; e < 1024; ++e) {
    EXPECT_EQ(exact({std::ldexp(1, e)}), std::ldexp(1, e));
    EXPECT_EQ(exact({-std::ldexp(1, e)}), -std::ldexp(1, e));
  }
}

TEST(Superaccumulator, Denormals) {
  EXPECT_EQ(exact({smallest, smallest, smallest}), 3 * smallest);
  EXPECT_EQ(exact({Limits::min(), -smallest}), Limits::min() - smallest);
  EXPECT_EQ(exact({-smallest, -smallest}), -2 * smallest);
  EXPECT_EQ(exact(std::vector<double>(1 << 12, 0x1p-1062)), 0x1p-1050);
}

TEST(Superaccumulator, OverflowOnlyWhereTheTotalDoes) {
  EXPECT_EQ(exact({largest, largest, -largest}), largest);
  EXPECT_EQ(exact({-largest, -largest, largest, 1}), -largest);
  EXPECT_EQ(exact({largest, largest, largest, -largest, -largest, -largest, 2}), 2);
  EXPECT_EQ(exact({largest, largest}), inf);
  EXPECT_EQ(exact({-largest, -largest}), -inf);
  EXPECT_EQ(exact({largest, 0x1p969}), largest);  // below half an ulp
  EXPECT_EQ(exact({largest, 0x1p970}), inf);      // half an ulp: IEEE rounds up to infinity
}

TEST(Superaccumulator, NonFiniteGivesNan) {
  EXPECT_TRUE(std::isnan(exact({1, Limits::quiet_NaN(), 2})));
  EXPECT_TRUE(std::isnan(exact({1, inf, 2})));
  EXPECT_TRUE(std::isnan(exact({-inf, inf})));
  EXPECT_TRUE(std::isnan(exact({-Limits::quiet_NaN()})));
}

// Ties, and values slightly to either side of a tie, for even and odd numbers and distant exponents.
TEST(Superaccumulator, RoundsTiesToEven) {
  std::mt19937_64 random(5);
  for (int n = 0; n < 4000; ++n) {
    const double base = 0x1p52 + static_cast<double>(random() >> 12), half = .5;  // ulp 1
    const double hair = std::ldexp(1, -10 - static_cast<int>(random() % 1000));
    const double sign = random() & 1 ? 1 : -1, even = std::fmod(base, 2) == 0 ? base : base + 1;
    EXPECT_EQ(exact({sign * half, sign * base}), sign * even);
    EXPECT_EQ(exact({sign * half, sign * base, -sign * hair}), sign * base);
    EXPECT_EQ(exact({sign * hair, sign * base, sign * half}), sign * (base + 1));
  }
}

TEST(Superaccumulator, RoundsThousandsOfRandomSetsCorrectlyInAnyOrder) {
  std::mt19937_64 random(1);
  int wrong = 0, order_dependent = 0, negative = 0, naive_is_wrong = 0;
  for (int set = 0; set < 6000; ++set) {
    const int count = 1 + static_cast<int>(random() % 60);
    const int spread = set % 3 == 0 ? 8 : set % 3 == 1 ? 120 : 1900;  // of exponents
    const int lowest = set % 3 == 2 ? -1074 : -60;
    std::vector<double> terms;
    for (int n = 0; n < count; ++n) {
      const double mantissa = 1 + std::ldexp(static_cast<double>(random() >> 12), -52);
      const double term = std::ldexp(mantissa, lowest + static_cast<int>(random() % spread));
      terms.push_back(random() & 1 ? term : -term);
      if (random() % 3 == 0) terms.push_back(-terms[random() % terms.size()]);  // cancellation
    }
    const double sum = exact(terms);
    double naive = 0;
    for (const double term : terms) naive += term;
    wrong += bits(sum) != bits(shewchuk(terms) + 0.0);
    negative += sum < 0;
    naive_is_wrong += naive != sum;
    for (int n = 0; n < 3; ++n) {
      std::shuffle(terms.begin(), terms.end(), random);
      order_dependent += bits(exact(terms)) != bits(sum);
    }
  }
  EXPECT_EQ(wrong, 0);
  EXPECT_EQ(order_dependent, 0);
  EXPECT_GT(negative, 1000);
  EXPECT_GT(naive_is_wrong, 1000);  // the sets are difficult enough for a naive sum
}

// Adding several values at once gives their exact sum, for exponents that differ by up to `spread`. With values of one
// sign the sums of the parts are largest.
TEST(Superaccumulator, SeveralAtOnceAreTheirExactSum) {
  std::mt19937_64 random(11);
  const auto between = [&](int low, int high) { return low + int(random() % std::uint64_t(high - low + 1)); };
  for (const int spread : {0, 1, 30, 46, 60, 93, 100, 141, 300})
    for (const bool both_signs : {false, true})
      for (const int top : {0, 60, -400, 850, 1020, -850, -1000})
        for (int round = 0; round < 20; ++round) {
          std::vector<double> values(round < 10 ? Superaccumulator::buffer_size
                                                : between(1, Superaccumulator::buffer_size));
          for (double &v : values) {
            const double mantissa = 2 - std::ldexp(double(random() % (round % 2 ? 1ull << 52 : 4)), -52);
            v = std::ldexp(mantissa, std::max(top - between(0, spread), -1073)) * (both_signs && random() % 2 ? -1 : 1);
            if (round == 5 && random() % 4 == 0) v = 0;
          }
          Superaccumulator at_once, one_by_one;
          at_once.add(values.data(), int(values.size()));
          for (const double v : values) one_by_one.add(v);
          // Subtracting the leading part reveals errors that rounding would hide.
          for (int part = 0; part < 4; ++part) {
            const double sum = one_by_one.value();
            ASSERT_EQ(bits(at_once.value()), bits(sum)) << spread << ' ' << top << ' ' << values.size() << ' ' << part;
            if (std::isinf(sum)) break;
            at_once.add(-sum);
            one_by_one.add(-sum);
          }
        }
  for (const double bad : {inf, -inf, Limits::quiet_NaN()}) {
    const double values[3] = {1, bad, 2};
    Superaccumulator sum;
    sum.add(values, 3);
    EXPECT_TRUE(std::isnan(sum.value())) << bad;
  }
}

// Carries of many additions: 2^22 terms of 53 bits with a known total.
TEST(Superaccumulator, ManyAdditions) {
  const double term = 0x1.fffffffffffffp+10;
  Superaccumulator up, down;
  for (int n = 0; n < 1 << 22; ++n) {
    up.add(term);
    down.add(-term);
  }
  EXPECT_EQ(up.value(), std::ldexp(term, 22));
  EXPECT_EQ(down.value(), -std::ldexp(term, 22));
}

// Definition of lane_sum(): element i is added to lane i mod 8 in ascending order, then follows a fixed tree.
double defined_lane_sum(const double *values, int n, std::int64_t first) {
  double lane[8] = {};
  for (int i = 0; i < n; ++i) lane[(first + i) % 8] += values[i];
  return ((lane[0] + lane[4]) + (lane[2] + lane[6])) + ((lane[1] + lane[5]) + (lane[3] + lane[7]));
}

std::vector<double> random_row(int n, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  std::vector<double> row(n);
  for (double &value : row) value = normal(random) * std::exp(3 * normal(random));
  return row;
}

TEST(LaneSum, IsItsDefinitionAtAnyOffsetAndLength) {
  const std::vector<double> row = random_row(600, 2);
  int another_order = 0;
  for (int first = 0; first < 17; ++first)
    for (int n = 0; n <= 256; ++n)
      for (const int shift : {0, 3}) {  // the memory alignment must not matter
        const double *values = row.data() + first + shift;
        EXPECT_EQ(bits(lane_sum(values, n, first)), bits(defined_lane_sum(values, n, first)));
        another_order += std::accumulate(values, values + n, 0.0) != lane_sum(values, n, first);
      }
  EXPECT_GT(another_order, 1000);  // the rows distinguish the order of summation
}

TEST(ExactSums, SumsRowsInBlocksOfTheAbsoluteIndex) {
  for (const int first : {0, 1, 200, 255, 256, 1000})
    for (const int n : {1, 7, 56, 57, 256, 257, 700}) {
      const std::vector<double> row = random_row(n, 100 * first + n);
      ExactSums sums(2);
      sums.add_row(1, row.data(), n, first);
      sums.add(0, 5);
      std::vector<double> blocks;
      for (int b = 0; b < (first + n + 255) / 256; ++b) {
        const int begin = std::max(256 * b, first) - first, end = std::min(256 * (b + 1), first + n) - first;
        if (begin < end) blocks.push_back(defined_lane_sum(row.data() + begin, end - begin, first + begin));
      }
      double result[2];
      ASSERT_EQ(sums.reduce(PETSC_COMM_SELF, result), 0);
      EXPECT_EQ(result[0], 5);
      EXPECT_EQ(bits(result[1]), bits(shewchuk(blocks)));
    }
}

TEST(ExactSums, ANonFiniteValueSpoilsItsSumAlone) {
  for (const double bad : {Limits::quiet_NaN(), inf, -inf})
    for (const int at : {0, 9, 299}) {
      std::vector<double> row(300, 1);
      ExactSums sums(3);
      sums.add_row(0, row.data(), 300, 4);
      row[at] = bad;
      sums.add_row(1, row.data(), 300, 4);
      sums.add_row(2, row.data(), at, 4);
      double result[3];
      ASSERT_EQ(sums.reduce(PETSC_COMM_SELF, result), 0);
      EXPECT_EQ(result[0], 300);
      EXPECT_TRUE(std::isnan(result[1]));
      EXPECT_EQ(result[2], at);
      sums.clear();
      sums.add_row(1, row.data(), at, 4);
      ASSERT_EQ(sums.reduce(PETSC_COMM_SELF, result), 0);
      EXPECT_EQ(result[1], at) << "clear() forgets";
    }
}

}  // namespace
}  // namespace eulastic
