// Elastic force and stretching on fields for which central differences are exact, in every component; energy.
#include "flow/projection.hpp"
#include "kernels/upper_convected.hpp"
#include "support/solid_box.hpp"

#include <gtest/gtest.h>

using namespace eulastic;
using namespace eulastic::test;

namespace {

TEST(ElasticForce, ExactForLinearFractionAndTensor) {
  for (const bool flat : {false, true})
    for (int seed = 0; seed < 4; ++seed) {
      Solid solid(flat, 1, seed);
      solid.fluid.inertia = false;
      solid.fluid.density = 1.7;
      for (int a = 0; a < solid.domain.dimension(); ++a) solid.v[a] = Polynomial{};
      solid.fill();
      const double dt = 0.37;
      ASSERT_EQ(
          predict(solid.domain, solid.fluid, 0, dt, solid.velocity, solid.pressure, solid.phases, solid.velocity_star),
          0);
      for (int a = 0; a < solid.domain.dimension(); ++a)
        EXPECT_LT(largest_error(solid.domain, solid.velocity_star[a], at_face[a],
                                [&](const Point &x) {
                                  double force = 0;
                                  for (int d = 0; d < solid.domain.dimension(); ++d)
                                    force += solid.phi(x) * solid.deviator_slope(a, d, d, x) +
                                             solid.phi.slope(d, x) * solid.deviator(a, d, x);
                                  return dt * 0.7 / 1.7 * force;
                                }),
                  2e-13)
            << "uvw"[a] << " seed " << seed;
    }
}

TEST(ElasticForce, NoneWithoutStrain) {
  for (const bool flat : {false, true}) {
    Solid solid(flat, 2, 5);
    const auto &components = tensor_components(solid.domain.dimension());
    for (const auto [a, b, at] : components) {
      solid.B[a][b] = Polynomial{};
      if (a == b) solid.B[a][b].c = 1;
    }
    solid.v[0] = solid.v[1] = solid.v[2] = Polynomial{};
    solid.fill();
    ASSERT_EQ(
        predict(solid.domain, solid.fluid, 0, 1, solid.velocity, solid.pressure, solid.phases, solid.velocity_star), 0);
    for (int a = 0; a < solid.domain.dimension(); ++a)
      EXPECT_EQ(largest_error(solid.domain, solid.velocity_star[a], at_face[a], [](const Point &) { return 0.0; }), 0);
  }
}

TEST(Stretching, ExactForLinearFlowAndTensor) {
  for (const bool flat : {false, true})
    for (const int degree : {0, 1})
      for (int seed = 0; seed < 4; ++seed) {
        Solid solid(flat, degree, 10 + seed);
        solid.make_positive();
        const double dt = 0.37;
        ASSERT_EQ(transport(solid.domain, dt, solid.velocity, solid.phases[0], solid.next), 0);
        const auto &components = tensor_components(solid.domain.dimension());
        for (int c = 0; c < solid.next.count(); ++c) {
          const auto [a, b, at] = components[c];
          EXPECT_LT(
              largest_error(solid.domain, solid.next[c], components[c].at,
                            [&, a = a, b = b](const Point &x) { return solid.B[a][b](x) + dt * solid.rate(a, b, x); }),
              2e-13)
              << "xyz"[a] << "xyz"[b] << " degree " << degree << " seed " << seed;
        }
      }
}

TEST(Stretching, SecondStageOfHeunIsTheMean) {
  for (const bool flat : {false, true}) {
    Solid solid(flat, 1, 15);
    solid.make_positive();
    const auto &components = tensor_components(solid.domain.dimension());
    for (int c = 0; c < solid.next.count(); ++c)
      fill_everywhere(solid.domain, solid.next[c], components[c].at, solid.v[0]);
    const double dt = 0.37;
    ASSERT_EQ(transport_tensor(solid.domain, {dt, true}, solid.velocity, solid.phases[0], solid.phases[0].tensor.field,
                               solid.next),
              0);
    for (int c = 0; c < solid.next.count(); ++c) {
      const auto [a, b, at] = components[c];
      EXPECT_LT(largest_error(solid.domain, solid.next[c], components[c].at,
                              [&, a = a, b = b](const Point &x) {
                                return 0.5 * (solid.v[0](x) + solid.B[a][b](x) + dt * solid.rate(a, b, x));
                              }),
                2e-13);
    }
  }
}

TEST(Stretching, RigidRotationLeavesTheUnitTensor) {
  for (const bool flat : {false, true}) {
    Solid solid(flat, 0, 20);
    for (int a = 0; a < 3; ++a)
      for (int b = 0; b < 3; ++b) {
        solid.B[a][b] = Polynomial{};
        solid.B[a][b].c = a == b;
        solid.v[a].g[b] = a == b ? 0 : a < b ? solid.v[a].g[b] : -solid.v[b].g[a];
      }
    solid.fill();
    ASSERT_EQ(transport(solid.domain, 1, solid.velocity, solid.phases[0], solid.next), 0);
    const auto &components = tensor_components(solid.domain.dimension());
    for (int c = 0; c < solid.next.count(); ++c)
      EXPECT_LT(largest_error(solid.domain, solid.next[c], components[c].at,
                              [&](const Point &) { return components[c].a == components[c].b ? 1.0 : 0.0; }),
                1e-14);
  }
}

// d(tr B)/dt by stretching alone, at centres.
void trace_rate(const Domain &domain, const Field &B, const Field &v, Field &rate) {
  const int dim = domain.dimension();
  const auto at = [dim](int a, int b) { return a == b ? a : dim == 2 ? 2 : 6 - a - b; };
  for (const Segment &s : domain.rows())
    for (int a = 0; a < dim; ++a) {
      const int b = (a + 1) % dim, c = 3 - a - b;
      double *out = rate[0].row(s.j, s.k);
      const auto inverse = [&](int d) { return 1 / domain.spacing()[d]; };
      const kernels::Directions d{v[0].stride(a), v[0].stride(b), v[0].stride(c), inverse(a), inverse(b), inverse(c)};
      const auto row = [&s](ConstView q) { return q.row(s.j, s.k); };
      const double *aa = row(B[a]), *va = row(v[a]);
      for (int i = s.i_begin; i < s.i_end; ++i) {
        const kernels::MixtureShear shear{{va + i, nullptr, nullptr}};
        out[i] += 2 * (dim == 2 ? kernels::half_diagonal_stretch<2>(aa + i, row(B[2]) + i, nullptr, shear, d)
                                : kernels::half_diagonal_stretch<3>(aa + i, row(B[at(a, b)]) + i, row(B[at(a, c)]) + i,
                                                                    shear, d));
      }
    }
}

// The power of the elastic force is minus the rate of the elastic energy G phi (tr B - 3)/2, except for the part -tr
// B/3 of the deviator, which works against div v and vanishes for a solenoidal flow.
TEST(ElasticEnergy, PowerOfTheForceIsTheRateOfTheEnergy) {
  for (const bool flat : {false, true})
    for (const bool solenoidal : {false, true}) {
      Solid solid(flat, 0, 30);
      const Domain &domain = solid.domain;
      const int dim = domain.dimension();
      const double G = 0.7;
      Phase &phase = solid.phases[0];
      Random random(31);
      randomise(domain, phase.fraction, random, 1.5);
      randomise(domain, phase.tensor.field, random);
      randomise(domain, solid.velocity, random);
      if (solenoidal) randomise_solenoidal(domain, solid.velocity, random);
      Field force(domain, dim), zero(domain, dim), rate(domain, 1), D(domain, 1);
      ASSERT_EQ(predict(domain, solid.fluid, 0, 1, zero, solid.pressure, solid.phases, force), 0);
      ASSERT_EQ(compute_divergence(domain, 1, solid.velocity, D), 0);
      trace_rate(domain, phase.tensor.field, solid.velocity, rate);
      double power = 0, energy = 0, against_divergence = 0, largest_divergence = 0;
      for (int k = 0; k < domain.cells()[2]; ++k)
        for (int j = 0; j < domain.cells()[1]; ++j)
          for (int i = 0; i < domain.cells()[0]; ++i) {
            for (int a = 0; a < dim; ++a) power += solid.velocity[a](i, j, k) * force[a](i, j, k);
            double trace = dim == 2 ? 1 : phase.tensor.field[2](i, j, k);
            trace += phase.tensor.field[0](i, j, k) + phase.tensor.field[1](i, j, k);
            const double stiffness = G * phase.fraction[0](i, j, k);
            energy += stiffness / 2 * rate[0](i, j, k);
            against_divergence += stiffness * trace / 3 * D[0](i, j, k);
            largest_divergence = std::max(largest_divergence, std::fabs(D[0](i, j, k)));
          }
      EXPECT_GT(std::fabs(energy), 1);  // the sum must not be trivially small
      EXPECT_NEAR(power, -energy + against_divergence, 1e-11) << "flat " << flat;
      if (solenoidal) {
        EXPECT_LT(largest_divergence, 1e-12);
        EXPECT_NEAR(power, -energy, 1e-11);
      } else {
        EXPECT_GT(std::fabs(against_divergence), 1e-2);
      }
    }
}

}  // namespace
