// Averaged velocities, the terms of the predictor, divergence and correction: exact for polynomials with unequal
// spacings.
#include "kernels/momentum.hpp"
#include "flow/correction.hpp"
#include "flow/projection.hpp"
#include "support/polynomials.hpp"
#include "support/verbs.hpp"

#include <gtest/gtest.h>

using namespace eulastic;
using namespace eulastic::test;

namespace {

// Returns the mean of a component over its faces within half a cell of the point, in all directions.
double mean_of_near_faces(const Domain &domain, ConstView q, int d, const Staggering &at, const Int3 &point) {
  double sum = 0;
  int count = 0;
  for (int dk = -1; dk <= 1; ++dk)
    for (int dj = -1; dj <= 1; ++dj)
      for (int di = -1; di <= 1; ++di) {
        const Int3 face{point[0] + di, point[1] + dj, point[2] + dk};
        bool near = true;
        for (int e = 0; e < 3; ++e) {
          const double distance = face[e] + (e == d ? 0 : 0.5) - point[e] - (at[e] ? 0 : 0.5);
          near = near && std::fabs(distance) <= (e < domain.dimension() ? 0.5 : 0.0);
        }
        if (!near) continue;
        sum += q(face[0], face[1], face[2]);
        ++count;
      }
  return sum / count;
}

TEST(CarryVelocity, IsTheMeanOfTheNearestFaces) {
  Random random(1);
  for (const bool flat : {false, true}) {
    Domain domain;
    ASSERT_EQ(domain.create(PETSC_COMM_SELF, uneven_box(flat)), 0);
    const int dim = domain.dimension();
    Field velocity(domain, dim);
    randomise(domain, velocity, random);
    for (int d = 0; d < dim; ++d)
      for (int set = 0; set < (1 << dim); ++set) {
        const Staggering at{(set & 1) != 0, (set & 2) != 0, (set & 4) != 0};
        std::vector<double> out(domain.cells()[0], 99);
        for (const Segment &row : domain.rows()) {
          kernels::average_velocity(Segment{2, row.i_end - 1, row.j, row.k}, velocity[d], d, at.data(), dim,
                                    out.data());
          for (int i = 2; i < row.i_end - 1; ++i)
            EXPECT_NEAR(out[i], mean_of_near_faces(domain, velocity[d], d, at, {i, row.j, row.k}), 1e-15)
                << "xyz"[d] << " at " << set;
        }
        EXPECT_EQ(out[1], 99);
        EXPECT_EQ(out.back(), 99);
      }
  }
}

struct Flow {
  Domain domain;
  Fluid fluid;
  Field velocity, pressure, out;
  Polynomial v[3], p;

  Flow(bool flat, int degree, int seed) {
    EXPECT_EQ(domain.create(PETSC_COMM_SELF, uneven_box(flat)), 0);
    Random random(seed);
    fluid.density = 1.7;
    fluid.viscosity = 0.6;
    fluid.body_force.force = {0.3, -0.2, 0.5};
    velocity = Field(domain, domain.dimension());
    out = Field(domain, domain.dimension());
    pressure = Field(domain, 1);
    for (int a = 0; a < domain.dimension(); ++a) {
      v[a] = Polynomial(random, degree);
      fill_everywhere(domain, velocity[a], at_face[a], v[a]);
    }
    p = Polynomial(random, 2);
    fill_everywhere(domain, pressure[0], at_centre, p);
  }
};

TEST(Predictor, ViscousPressureAndForceAreExactOnQuadratics) {
  for (const bool flat : {false, true}) {
    Flow flow(flat, 2, 2);
    flow.fluid.inertia = false;
    const double dt = 0.37;
    ASSERT_EQ(predict(flow.domain, flow.fluid, 0, dt, flow.velocity, flow.pressure, {}, flow.out), 0);
    for (int a = 0; a < flow.domain.dimension(); ++a)
      EXPECT_LT(largest_error(flow.domain, flow.out[a], at_face[a],
                              [&](const Point &x) {
                                return flow.v[a](x) + dt * (0.6 / 1.7 * flow.v[a].laplacian(flow.domain.dimension()) -
                                                            flow.p.slope(a, x) / 1.7 + flow.fluid.body_force.force[a]);
                              }),
                2e-13)
          << "uvw"[a];
  }
}

TEST(Predictor, InertiaIsExactOnLinearFlows) {
  for (const bool flat : {false, true}) {
    Flow flow(flat, 1, 3);
    const double dt = 0.37;
    ASSERT_EQ(predict(flow.domain, flow.fluid, 0, dt, flow.velocity, flow.pressure, {}, flow.out), 0);
    for (int a = 0; a < flow.domain.dimension(); ++a)
      EXPECT_LT(largest_error(flow.domain, flow.out[a], at_face[a],
                              [&](const Point &x) {
                                double rate = flow.fluid.body_force.force[a] - flow.p.slope(a, x) / 1.7;
                                for (int d = 0; d < flow.domain.dimension(); ++d) rate -= flow.v[d](x) * flow.v[a].g[d];
                                return flow.v[a](x) + dt * rate;
                              }),
                2e-13)
          << "uvw"[a];
  }
}

TEST(Predictor, ForceFollowsItsTime) {
  Flow flow(true, 1, 4), later(true, 1, 4);
  flow.fluid.body_force.frequency = later.fluid.body_force.frequency = 2;
  flow.fluid.body_force.phase = later.fluid.body_force.phase = 0.3;
  ASSERT_EQ(predict(flow.domain, flow.fluid, 0, 1, flow.velocity, flow.pressure, {}, flow.out), 0);
  ASSERT_EQ(predict(later.domain, later.fluid, 0.7, 1, later.velocity, later.pressure, {}, later.out), 0);
  EXPECT_NEAR(later.out[0](1, 1, 0) - flow.out[0](1, 1, 0), 0.3 * (std::cos(1.7) - std::cos(0.3)), 1e-14);
  EXPECT_NEAR(later.out[1](1, 1, 0) - flow.out[1](1, 1, 0), -0.2 * (std::cos(1.7) - std::cos(0.3)), 1e-14);
}

TEST(Divergence, ExactOnQuadratics) {
  for (const bool flat : {false, true}) {
    Flow flow(flat, 2, 5);
    Field D(flow.domain, 1);
    ASSERT_EQ(compute_divergence(flow.domain, 1.7, flow.velocity, D), 0);
    EXPECT_LT(largest_error(flow.domain, D[0], at_centre,
                            [&](const Point &x) {
                              double sum = 0;
                              for (int a = 0; a < flow.domain.dimension(); ++a) sum += flow.v[a].slope(a, x);
                              return 1.7 * sum;
                            }),
              1e-13);
  }
}

TEST(Laplacian, ExactOnQuadratics) {
  for (const bool flat : {false, true}) {
    Flow flow(flat, 2, 6);
    const InverseSquares h = flow.domain.inverse_squares();
    const ConstView p = flow.pressure[0];
    for (const Segment &s : flow.domain.rows())
      for (int i = 0; i < s.i_end; ++i) {
        const double *q = p.row(s.j, s.k) + i;
        EXPECT_NEAR(flat ? kernels::laplacian<2>(q, p.sy, p.sz, h) : kernels::laplacian<3>(q, p.sy, p.sz, h),
                    flow.p.laplacian(flow.domain.dimension()), 5e-13);
      }
  }
}

TEST(Rate, IsWhatThePredictorAdvancesBy) {
  for (const bool flat : {false, true}) {
    Flow flow(flat, 1, 9);
    Field none, rate(flow.domain, flow.domain.dimension());
    const MomentumStep step{0, 0.37, 1, {}};
    ASSERT_EQ(momentum_rate(flow.domain, flow.fluid, step, flow.velocity, flow.pressure, {}, none, rate), 0);
    ASSERT_EQ(predict_velocity(flow.domain, flow.fluid, step, flow.velocity, flow.pressure, {}, flow.out), 0);
    for (int a = 0; a < flow.domain.dimension(); ++a)
      for (const Segment &s : flow.domain.rows())
        for (int i = 0; i < s.i_end; ++i)
          EXPECT_EQ(flow.out[a](i, s.j, s.k), std::fma(step.dt, rate[a](i, s.j, s.k), flow.velocity[a](i, s.j, s.k)));
  }
}

TEST(Rate, WeighsTheAdvectionOfTwoSteps) {
  for (const bool flat : {false, true}) {
    Flow flow(flat, 1, 7), before(flat, 1, 8);
    Field advection(flow.domain, flow.domain.dimension());
    const auto rate = [&](Flow &f, AdvectionWeights weights) {
      ASSERT_EQ(momentum_rate(f.domain, f.fluid, {0, 0.37, 1, weights}, f.velocity, f.pressure, {}, advection, f.out),
                0);
    };
    const auto check = [](const Flow &f, const AdvectionWeights &weights, const Flow &last) {
      for (int a = 0; a < f.domain.dimension(); ++a)
        EXPECT_LT(largest_error(f.domain, f.out[a], at_face[a],
                                [&](const Point &x) {
                                  double exact = f.fluid.body_force.force[a] - f.p.slope(a, x) / 1.7;
                                  for (int d = 0; d < f.domain.dimension(); ++d)
                                    exact -= weights.now * f.v[d](x) * f.v[a].g[d] +
                                             weights.before * last.v[d](x) * last.v[a].g[d];
                                  return exact;
                                }),
                  2e-13)
            << "uvw"[a];
    };
    rate(before, {1, 0});
    check(before, {1, 0}, before);
    rate(flow, {1.6, -0.6});
    check(flow, {1.6, -0.6}, before);
    rate(before, {1.5, -0.5});
    check(before, {1.5, -0.5}, flow);
  }
}

TEST(Correction, ExactOnQuadraticsAndInOneGhostOfThePressure) {
  for (const bool flat : {false, true}) {
    Flow flow(flat, 2, 7);
    Random random(8);
    const Polynomial dp(random, 2), D(random, 2);
    Field increment(flow.domain, 1), divergence(flow.domain, 1);
    fill_everywhere(flow.domain, increment[0], at_centre, dp);
    fill_everywhere(flow.domain, divergence[0], at_centre, D);
    const double dt = 0.37, rotation = 0.3;
    ASSERT_EQ(correct_velocity(flow.domain, 1.7, dt, rotation, increment, divergence, flow.velocity, flow.pressure), 0);
    for (int a = 0; a < flow.domain.dimension(); ++a)
      EXPECT_LT(largest_error(flow.domain, flow.velocity[a], at_face[a],
                              [&](const Point &x) { return flow.v[a](x) - dt / 1.7 * dp.slope(a, x); }),
                1e-13);
    const Int3 n = flow.domain.cells();
    const int gz = flat ? 0 : 1;
    double largest = 0;
    for (int k = -gz; k < n[2] + gz; ++k)
      for (int j = -1; j <= n[1]; ++j)
        for (int i = -1; i <= n[0]; ++i) {
          const Point x = point(flow.domain, at_centre, i, j, k);
          const double exact = flow.p(x) + dp(x) - rotation * D(x);
          largest = std::max(largest, std::fabs(flow.pressure[0](i, j, k) - exact));
        }
    EXPECT_LT(largest, 1e-14);
  }
}

}  // namespace
