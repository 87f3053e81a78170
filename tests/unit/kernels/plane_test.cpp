// Planes in cells: volume and constant are inverse functions, a linear interface has exact fluxes, limits are
// respected.
#include "kernels/plane.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

using namespace eulastic;
using kernels::plane_constant;
using kernels::plane_flux;
using kernels::volume_below;

namespace {

struct Plane {
  double a, b, c;  // with the sum 1
};

class RandomPlanes : public ::testing::Test {
protected:
  std::mt19937_64 random{7};
  double uniform(double low, double high) { return low + (high - low) * std::generate_canonical<double, 53>(random); }
  // Often close to 0 or 1.
  double any_phi() {
    const double q = uniform(0, 1), small = std::pow(10, uniform(-18, 0));
    return q < 0.4 ? uniform(0, 1) : q < 0.7 ? small : 1 - small;
  }
  // Often along an axis or a diagonal, exactly or nearly.
  Plane any_plane(int dimension) {
    double m[3] = {};
    do
      for (int d = 0; d < dimension; ++d) {
        const double kind = uniform(0, 1);
        m[d] = kind < 0.1 ? 0 : kind < 0.2 ? 1 : kind < 0.4 ? std::pow(10, uniform(-25, 0)) : uniform(0, 1);
      }
    while (m[0] + m[1] + m[2] == 0);
    if (uniform(0, 1) < 0.1) m[1] = m[0] * (1 + uniform(-1e-15, 1e-15));
    const double sum = m[0] + m[1] + m[2];
    if (sum == 0) return {1, 0, 0};
    return {m[0] / sum, m[1] / sum, m[2] / sum};
  }
};

// Volume below a plane by inclusion and exclusion, a formula that cancels where a component is small.
long double volume_by_corners(int dimension, long double alpha, const Plane &p) {
  const long double m[3] = {p.a, p.b, p.c};
  long double sum = 0, product = dimension == 2 ? 2 : 6;
  for (int d = 0; d < dimension; ++d) product *= m[d];
  for (int corner = 0; corner < 1 << dimension; ++corner) {
    long double rest = alpha, sign = 1;
    for (int d = 0; d < dimension; ++d)
      if (corner >> d & 1) {
        rest -= m[d];
        sign = -sign;
      }
    if (rest > 0) sum += sign * std::pow(rest, dimension);
  }
  return sum / product;
}

TEST_F(RandomPlanes, HaveTheVolumeOfTheirCorners) {
  for (int n = 0; n < 20000; ++n) {
    const double a = uniform(0.05, 1), b = uniform(0.05, 1), c = uniform(0.05, 1), alpha = uniform(0, a + b + c);
    EXPECT_NEAR(volume_below<3>(alpha, a, b, c), volume_by_corners(3, alpha, {a, b, c}), 1e-14);
    const double flat = uniform(0, a + b);
    EXPECT_NEAR(volume_below<2>(flat, a, b, 0), volume_by_corners(2, flat, {a, b, 0}), 1e-14);
  }
}

TEST_F(RandomPlanes, ComeBackFromTheirVolume) {
  for (int n = 0; n < 1000000; ++n) {
    const double phi = any_phi();
    const Plane p = any_plane(3), q = any_plane(2);
    ASSERT_NEAR(volume_below<3>(plane_constant<3>(phi, p.a, p.b, p.c), p.a, p.b, p.c), phi, 1e-14)
        << p.a << " " << p.b << " " << p.c;
    ASSERT_NEAR(volume_below<2>(plane_constant<2>(phi, q.a, q.b, 0), q.a, q.b, 0), phi, 1e-14) << q.a << " " << q.b;
  }
}

// The constant does not depend on the order of the axes, and is 1/2 for half of the volume.
TEST_F(RandomPlanes, DoNotKnowTheirAxes) {
  for (int n = 0; n < 10000; ++n) {
    const double phi = any_phi();
    const Plane p = any_plane(3);
    EXPECT_EQ(plane_constant<3>(phi, p.a, p.b, p.c), plane_constant<3>(phi, p.c, p.a, p.b));
    EXPECT_EQ(plane_constant<3>(phi, p.a, p.b, p.c), plane_constant<3>(phi, p.b, p.a, p.c));
    EXPECT_NEAR(plane_constant<3>(0.5, p.a, p.b, p.c), 0.5, 1e-14);
  }
}

TEST_F(RandomPlanes, GiveNoMoreThanThereIs) {
  for (int n = 0; n < 100000; ++n) {
    const double phi = any_phi(), courant = uniform(0, 1) * std::pow(10, uniform(-9, 0));
    const Plane p = any_plane(3);
    const double sign = n % 2 ? 1 : -1, alpha = plane_constant<3>(phi, p.a, p.b, p.c);
    const double flux = plane_flux<3>(phi, alpha, sign * p.a, p.b, p.c, courant);
    EXPECT_GE(flux, 0);
    EXPECT_LE(flux, std::min(phi, courant));
    EXPECT_GE(flux, courant - (1 - phi));
  }
}

// Exchanging fluid and solid; and the fluxes through opposite faces add up to the volume of the cell.
TEST_F(RandomPlanes, AddUp) {
  for (int n = 0; n < 100000; ++n) {
    const double phi = any_phi(), courant = uniform(0, 1);
    const Plane p = any_plane(3);
    const auto flux = [&](double q, double towards, double c) {
      return plane_flux<3>(q, plane_constant<3>(q, p.a, p.b, p.c), towards, p.b, p.c, c);
    };
    EXPECT_NEAR(flux(phi, p.a, courant) + flux(1 - phi, -p.a, courant), courant, 1e-14);
    EXPECT_NEAR(flux(phi, p.a, courant) + flux(phi, -p.a, 1 - courant), phi, 1e-14);
  }
}

// The volume before the face, by integrating the depth of the plane over the face.
TEST_F(RandomPlanes, HaveExactFluxes) {
  for (int n = 0; n < 200; ++n) {
    const Plane p{uniform(0.1, 1), uniform(0.1, 1), uniform(0.1, 1)};
    const double sum = p.a + p.b + p.c, alpha = uniform(0.05, 0.95), courant = uniform(0.01, 0.9);
    const double a = p.a / sum, b = p.b / sum, c = p.c / sum, phi = volume_below<3>(alpha, a, b, c);
    const int points = 400;
    double towards = 0, away = 0;
    for (int j = 0; j < points; ++j)
      for (int k = 0; k < points; ++k) {
        const double depth = (alpha - b * (j + 0.5) / points - c * (k + 0.5) / points) / a;
        towards += std::min(std::max(depth, 0.0), courant) / (points * points);
        away += std::min(std::max(depth - (1 - courant), 0.0), courant) / (points * points);
      }
    const double found = plane_constant<3>(phi, a, b, c);
    EXPECT_NEAR(found, alpha, 1e-13);
    EXPECT_NEAR(plane_flux<3>(phi, found, a, b, c, courant), towards, 1e-5);  // midpoint rule: kinks cost 1/points^2
    EXPECT_NEAR(plane_flux<3>(phi, found, -a, b, c, courant), away, 1e-5);
  }
}

TEST(PlaneFlux, IsExactAlongAnAxis) {
  for (const double phi : {1e-9, 0.05, 0.3, 0.95, 1 - 1e-9})
    for (const double courant : {1e-6, 0.1, 0.4}) {
      const double alpha = plane_constant<3>(phi, 1, 0, 0);
      EXPECT_NEAR(plane_flux<3>(phi, alpha, 1, 0, 0, courant), std::min(phi, courant), 1e-16);
      EXPECT_NEAR(plane_flux<3>(phi, alpha, -1, 0, 0, courant), std::max(0.0, courant - (1 - phi)), 1e-16);
      EXPECT_NEAR(plane_flux<3>(phi, alpha, 0, 1, 0, courant), courant * phi, 1e-16);
      EXPECT_EQ(plane_flux<3>(phi, 0, 0, 0, 0, courant), courant * phi);  // no normal
      EXPECT_EQ(plane_flux<2>(phi, 0, 0, 0, 0, courant), courant * phi);
    }
}

// Small remainders beside their body leave completely towards it, also in small steps, and not away from it.
TEST(PlaneFlux, LeavesNothingBehind) {
  for (const double phi : {1e-12, 1e-7, 1e-4}) {
    const double alpha = plane_constant<3>(phi, 0.5, 0.3, 0.2);
    EXPECT_NEAR(plane_flux<3>(phi, alpha, 0.5, 0.3, 0.2, 0.1), phi, 1e-15 * phi);
    EXPECT_EQ(plane_flux<3>(phi, alpha, -0.5, 0.3, 0.2, 0.1), 0);
  }
}

}  // namespace
