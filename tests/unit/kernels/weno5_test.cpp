// WENO5 is compared with its textbook form, polynomials and smooth data; symmetry, steps, constants, pieces of rows.
#include "support/advection.hpp"
#include "support/polynomials.hpp"

#include <gtest/gtest.h>

#include <cstring>
#include <limits>

using namespace eulastic;
using namespace eulastic::test;
using kernels::weno5_difference;

namespace {

constexpr double pi = 3.14159265358979323846;

// The formulas of Jiang & Shu (1996) in undivided differences.
double jiang_shu(const double *q, bool from_left, double epsilon) {
  double v[5];
  for (int m = 0; m < 5; ++m) v[m] = from_left ? q[m - 2] - q[m - 3] : q[3 - m] - q[2 - m];
  const auto square = [](double x) { return x * x; };
  const double D[3] = {v[0] / 3 - 7 * v[1] / 6 + 11 * v[2] / 6, -v[1] / 6 + 5 * v[2] / 6 + v[3] / 3,
                       v[2] / 3 + 5 * v[3] / 6 - v[4] / 6};
  const double IS[3] = {13. / 12 * square(v[0] - 2 * v[1] + v[2]) + square(v[0] - 4 * v[1] + 3 * v[2]) / 4,
                        13. / 12 * square(v[1] - 2 * v[2] + v[3]) + square(v[1] - v[3]) / 4,
                        13. / 12 * square(v[2] - 2 * v[3] + v[4]) + square(3 * v[2] - 4 * v[3] + v[4]) / 4};
  const double ideal[3] = {0.1, 0.6, 0.3};
  double above = 0, below = 0;
  for (int m = 0; m < 3; ++m) {
    const double weight = ideal[m] / square(epsilon + IS[m]);
    above += weight * D[m];
    below += weight;
  }
  return above / below;
}

// Seven points at every stride; all other values are poisoned.
struct Stencil {
  std::ptrdiff_t stride;
  std::vector<double> data;
  explicit Stencil(std::ptrdiff_t s) : stride(s), data(8 * std::abs(s) + 1, std::numeric_limits<double>::quiet_NaN()) {}
  double *centre() { return data.data() + 4 * std::abs(stride); }
  template <class F>
  double *fill(F f) {
    for (int m = -3; m <= 3; ++m) centre()[m * stride] = f(m);
    return centre();
  }
};

TEST(Weno5, EqualsTheTextbook) {
  Random random(1);
  Stencil line(1);
  for (const double epsilon : {1e-12, 1e-6, 1e-2, 1.0})
    for (int n = 0; n < 500; ++n) {
      const double scale = std::pow(10, 2 * random());
      double *q = line.fill([&](int) { return scale * random(); });
      for (const double velocity : {0.7, -0.7}) {
        const double exact = jiang_shu(q, velocity > 0, epsilon);
        for (const std::ptrdiff_t stride : {1, 7, -3}) {
          Stencil other(stride);
          const double *p = other.fill([&](int m) { return q[m]; });
          EXPECT_NEAR(weno5_difference(p, stride, velocity, epsilon), exact, 1e-12 * scale);
        }
      }
    }
}

// All three stencils are exact for cubics with any weights, and with the ideal weights (huge epsilon) for quintics.
TEST(Weno5, ExactOnPolynomials) {
  Random random(2);
  Stencil line(1);
  for (int n = 0; n < 100; ++n)
    for (int degree = 0; degree <= 5; ++degree) {
      double c[6];
      for (double &x : c) x = random();
      const double *q = line.fill([&](int m) {
        double sum = 0;
        for (int d = degree; d >= 0; --d) sum = sum * m + c[d];
        return sum;
      });
      const double size = std::pow(3, degree);
      for (const double velocity : {1.0, -1.0}) {
        EXPECT_NEAR(weno5_difference(q, 1, velocity, 1e20), degree > 0 ? c[1] : 0, 2e-14 * size) << degree;
        if (degree <= 3) {
          EXPECT_NEAR(weno5_difference(q, 1, velocity, 1e-6), degree > 0 ? c[1] : 0, 2e-14 * size) << degree;
        }
      }
    }
}

// rms error of -v.grad q, q = sin(2 pi x_d + 1), v = +-1 along d.
double advection_error(int d, int cells, double velocity) {
  GridSpec spec;
  spec.cells = {4, 4, 4};
  spec.cells[d] = cells;
  Domain domain;
  EXPECT_EQ(domain.create(PETSC_COMM_SELF, spec), 0);
  Field q(domain, 1);
  fill_everywhere(domain, q[0], at_centre, [d](const Point &x) { return std::sin(2 * pi * x[d] + 1); });
  const Int3 n = domain.cells();
  std::vector<double> along(n[0], velocity), across(n[0], 0.3 * velocity), rate(n[0]);
  const double *carried[3] = {across.data(), across.data(), across.data()};
  carried[d] = along.data();
  Real3 inverse;
  for (int e = 0; e < 3; ++e) inverse[e] = 1 / domain.spacing()[e];
  Field out(domain, 1);
  for (const Segment &s : domain.rows()) {
    advection_rate<3>(s, q[0], carried, inverse.data(), 1e-6, rate.data());
    std::copy(rate.begin(), rate.end(), out[0].row(s.j, s.k));
  }
  return rms_error(domain, out[0], at_centre, [=](double x, double y, double z) {
    return -velocity * 2 * pi * std::cos(2 * pi * Point{x, y, z}[d] + 1);
  });
}

TEST(Weno5, FifthOrderFromBothSidesInAllDirections) {
  for (int d = 0; d < 3; ++d)
    for (const double velocity : {1.0, -1.0}) {
      const double e[3] = {advection_error(d, 64, velocity), advection_error(d, 128, velocity),
                           advection_error(d, 256, velocity)};
      EXPECT_GT(order(e[0], e[1]), 4.8) << "xyz"[d] << velocity;
      EXPECT_GT(order(e[1], e[2]), 4.8) << "xyz"[d] << velocity;
      EXPECT_LT(e[2], 5e-8);
    }
}

TEST(Weno5, MirrorImageHasTheSameBits) {
  Random random(3);
  Stencil line(1), mirror(1);
  for (int n = 0; n < 2000; ++n) {
    double *q = line.fill([&](int) { return random(); });
    double *r = mirror.fill([&](int m) { return q[-m]; });
    const double velocity = random();
    EXPECT_EQ(weno5_difference(q, 1, velocity, 1e-6), -weno5_difference(r, 1, -velocity, 1e-6));
  }
}

TEST(Weno5, UnitsDoNotMatter) {
  Random random(4);
  Stencil line(1), scaled(1);
  for (const double scale : {0x1p-60, 0x1p-10, 0x1p40})
    for (int n = 0; n < 200; ++n) {
      double *q = line.fill([&](int) { return random(); });
      double *r = scaled.fill([&](int m) { return scale * q[m]; });
      EXPECT_EQ(scale * weno5_difference(q, 1, 1, 1e-6), weno5_difference(r, 1, 1, 1e-6 * scale * scale));
    }
}

TEST(Weno5, ConstantsHaveNoSlope) {
  Stencil line(1);
  for (const double value : {0.0, 1.0, -3e8, 1e-30})
    for (const double scale : {1e-30, 1e-9, 1.0, 1e9}) {
      const double *q = line.fill([=](int) { return value; });
      for (const double velocity : {1.0, 0.0, -1.0})
        EXPECT_EQ(weno5_difference(q, 1, velocity, 1e-6 * scale * scale), 0) << value << " " << scale;
    }
}

// A step changes only the cell behind it, and the difference is not much larger than the step.
TEST(Weno5, StepIsNotSmearedNorOvershot) {
  Stencil line(1);
  for (int step = -3; step < 3; ++step)  // between the points step and step + 1
    for (const double velocity : {1.0, -1.0}) {
      const double *q = line.fill([=](int m) { return m > step ? 1.0 : 0.0; });
      const double slope = weno5_difference(q, 1, velocity, 1e-6);
      const bool behind = step == (velocity > 0 ? -1 : 0);
      EXPECT_NEAR(slope, behind ? 1.0 : 0.0, behind ? 0.35 : 1e-5) << step << " " << velocity;
    }
}

TEST(Weno5, AdvectedStepStaysBounded) {
  const int n = 40;
  std::vector<double> q(n + 6), next(n + 6), velocity(n + 6, 1.0);
  for (int i = 0; i < n; ++i) q[i + 3] = i >= 10 && i < 25;
  const double *carried[3] = {velocity.data() + 3, velocity.data() + 3, velocity.data() + 3};
  const double inverse[3] = {1, 0, 0};
  for (int step = 0; step < 200; ++step) {  // 40 cells, one period
    for (int g = 0; g < 3; ++g) q[g] = q[n + g], q[n + 3 + g] = q[3 + g];
    std::vector<double> rate(n);
    advection_rate<2>(Segment{0, n, 0, 0}, {q.data() + 3, 0, 0}, carried, inverse, 1e-6, rate.data());
    for (int i = 0; i < n; ++i) q[i + 3] += 0.2 * rate[i];
  }
  const auto [low, high] = std::minmax_element(q.begin() + 3, q.begin() + 3 + n);
  std::printf("  step after 200 steps: %g to %g\n", *low, *high);
  EXPECT_GT(*low, -0.02);
  EXPECT_LT(*high, 1.02);
  EXPECT_GT(*high, 0.9);
  for (int i = 13; i < 22; ++i) EXPECT_NEAR(q[i + 3], 1, 0.1) << i;
  for (int i = 0; i < n; ++i) EXPECT_LT(i < 6 || i > 29 ? q[i + 3] : 0, 0.02) << i;
}

TEST(Weno5, AdvectionOfLinearFieldsIsExact) {
  Random random(5);
  for (const bool flat : {false, true}) {
    Domain domain;
    ASSERT_EQ(domain.create(PETSC_COMM_SELF, uneven_box(flat)), 0);
    const Polynomial q(random, 1);
    Field field(domain, 1), out(domain, 1);
    fill_everywhere(domain, field[0], at_centre, q);
    const Real3 &h = domain.spacing();
    const double inverse[3] = {1 / h[0], 1 / h[1], 1 / h[2]};
    std::vector<double> rows[3];
    for (auto &row : rows)
      for (int i = 0; i < domain.cells()[0]; ++i) row.push_back(random());
    const double *carried[3] = {rows[0].data(), rows[1].data(), rows[2].data()};
    for (const Segment &s : domain.rows()) {
      double *rate = out[0].row(s.j, s.k);
      if (flat)
        advection_rate<2>(s, field[0], carried, inverse, 1e-6, rate);
      else
        advection_rate<3>(s, field[0], carried, inverse, 1e-6, rate);
      for (int i = 0; i < s.i_end; ++i) {
        double exact = 0;
        for (int d = 0; d < domain.dimension(); ++d) exact -= rows[d][i] * q.g[d];
        EXPECT_NEAR(rate[i], exact, 1e-13);
      }
    }
  }
}

TEST(Weno5, PiecesOfARowHaveTheBitsOfTheWhole) {
  Random random(6);
  GridSpec spec = uneven_box(false, {37, 3, 3});
  Domain domain;
  ASSERT_EQ(domain.create(PETSC_COMM_SELF, spec), 0);
  Field q(domain, 1);
  randomise(domain, q, random);
  std::vector<double> velocity(37), whole(37), pieces(37);
  for (double &v : velocity) v = random();
  const double *carried[3] = {velocity.data(), velocity.data(), velocity.data()};
  const double inverse[3] = {37, 3, 2.7};
  advection_rate<3>(Segment{0, 37, 1, 1}, q[0], carried, inverse, 1e-6, whole.data());
  const int cuts[] = {0, 1, 8, 11, 27, 37};
  for (int c = 0; c < 5; ++c)
    advection_rate<3>(Segment{cuts[c], cuts[c + 1], 1, 1}, q[0], carried, inverse, 1e-6, pieces.data());
  EXPECT_EQ(std::memcmp(whole.data(), pieces.data(), sizeof(double) * 37), 0);
}

// Batches process all directions in one loop, rows one direction at a time.
TEST(Weno5, BatchesHaveTheBitsOfRows) {
  Random random(8);
  GridSpec spec = uneven_box(false, {37, 3, 3});
  Domain domain;
  ASSERT_EQ(domain.create(PETSC_COMM_SELF, spec), 0);
  Field q(domain, 1);
  randomise(domain, q, random);
  std::vector<double> velocity[3], row(37), batched(37);
  for (auto &v : velocity)
    for (int i = 0; i < 37; ++i) v.push_back(random());
  const double *carried[3] = {velocity[0].data(), velocity[1].data(), velocity[2].data()};
  const double inverse[3] = {37, 3, 2.7};
  advection_rate<3>(Segment{0, 37, 1, 1}, q[0], carried, inverse, 1e-6, row.data());
  int done = 0;
  const auto work = [&](const kernels::Batch &batch) {
    const double *left[3] = {carried[0] + done, carried[1] + done, carried[2] + done};
    kernels::advection_rate<3>(batch, q[0], left, inverse, 1e-6, batched.data() + done);
    done = 32;
  };
  kernels::Batch batch, rest;
  kernels::gather(batch, q[0].sy + q[0].sz, 0, 32, work);  // four vectors, which wait in the batch
  work(batch);
  kernels::gather(rest, q[0].sy + q[0].sz, 32, 37, work);  // less than a vector, processed at once
  EXPECT_EQ(std::memcmp(row.data(), batched.data(), sizeof(double) * 37), 0);
}

}  // namespace
