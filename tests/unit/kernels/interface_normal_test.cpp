// Normals of planes by the mixed Youngs-centred scheme, the choice between the two normals, and mirrored bits.
#include "kernels/interface_normal.hpp"
#include "kernels/interface_flux.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

using namespace eulastic;
using kernels::interface_normal;
using kernels::InterfaceNormal;

namespace {

// 3 x 3 x 3 cells; q(0, 0, 0) is the middle one.
struct Block {
  double value[27];
  double &q(int i, int j, int k) { return value[13 + i + 3 * j + 9 * k]; }
  InterfaceNormal normal() const { return interface_normal<3>(value + 13, 1, 3, 9); }
  InterfaceNormal flat_normal() const { return interface_normal<2>(value + 13, 1, 3, 0); }
};

// Sets the fractions of n.x < alpha for n of any signs, x from the low corner of the middle cell.
Block plane(const double (&n)[3], double alpha) {
  Block block;
  const double m[3] = {std::fabs(n[0]), std::fabs(n[1]), std::fabs(n[2])};
  for (int k = -1; k <= 1; ++k)
    for (int j = -1; j <= 1; ++j)
      for (int i = -1; i <= 1; ++i) {
        double rest = alpha - (n[0] * i + n[1] * j + n[2] * k);
        for (const double c : n) rest -= std::min(c, 0.0);
        block.q(i, j, k) = kernels::volume_below<3>(rest, m[0], m[1], m[2]);
      }
  return block;
}

// The normal is exact where the columns contain the whole plane.
TEST(InterfaceNormal, IsExactForPlanesAcrossColumns) {
  for (const double s : {-0.45, 0.0, 0.2, 0.5})
    for (const double t : {-0.3, 0.0, 0.4})
      for (int d = 0; d < 3; ++d)
        for (const double sign : {-1.0, 1.0}) {
          double n[3];
          n[d] = sign;
          n[(d + 1) % 3] = s;
          n[(d + 2) % 3] = t;
          const double alpha = (n[0] + n[1] + n[2]) / 2, sum = 1 + std::fabs(s) + std::fabs(t);
          const InterfaceNormal found = plane(n, alpha).normal();
          EXPECT_NEAR(found.a, -n[0] / sum, 1e-15);  // towards larger phi
          EXPECT_NEAR(found.b, -n[1] / sum, 1e-15);
          EXPECT_NEAR(found.c, -n[2] / sum, 1e-15);
        }
}

TEST(InterfaceNormal, IsYoungsNearADiagonal) {
  const double n[3] = {1, 0.95, 0.9};
  const Block block = plane(n, 1.2);
  const InterfaceNormal found = block.normal();
  const double *q = block.value + 13;
  const double g[3] = {kernels::youngs_component<3>(q, 1, 3, 9), kernels::youngs_component<3>(q, 3, 9, 1),
                       kernels::youngs_component<3>(q, 9, 1, 3)};
  const double sum = std::fabs(g[0]) + std::fabs(g[1]) + std::fabs(g[2]);
  EXPECT_NEAR(found.a, g[0] / sum, 1e-15);
  EXPECT_NEAR(found.b, g[1] / sum, 1e-15);
  EXPECT_NEAR(found.c, g[2] / sum, 1e-15);
  // Both are close to the normal of the plane.
  EXPECT_NEAR(found.a, -1 / 2.85, 0.01);
  EXPECT_NEAR(found.c, -0.9 / 2.85, 0.01);
}

// Youngs' normal differs from that of the columns where the latter is taken; otherwise the test above could not
// distinguish them.
TEST(InterfaceNormal, IsNotYoungsAcrossColumns) {
  const double n[3] = {0.4, 1, 0.2};
  const Block block = plane(n, 0.8);
  const double *q = block.value + 13;
  const double ga = kernels::youngs_component<3>(q, 1, 3, 9), gb = kernels::youngs_component<3>(q, 3, 9, 1);
  EXPECT_GT(std::fabs(ga / gb - 0.4), 1e-3);
  EXPECT_NEAR(block.normal().a / block.normal().b, 0.4, 1e-14);
}

TEST(InterfaceNormal, IsNothingWherePhiIsEvenOrUniform) {
  Block block;
  std::fill(block.value, block.value + 27, 0.3);
  EXPECT_EQ(block.normal().a, 0);
  EXPECT_EQ(block.flat_normal().b, 0);
  std::fill(block.value, block.value + 27, 0);
  block.q(0, 0, 0) = 0.7;  // no other cell is filled
  const InterfaceNormal found = block.normal();
  EXPECT_EQ(std::fabs(found.a) + std::fabs(found.b) + std::fabs(found.c), 0);
}

// The 2-D normal equals the 3-D one for fractions that are uniform along z.
TEST(InterfaceNormal, IsThatOf3DInAFlatScene) {
  std::mt19937_64 random{5};
  for (int n = 0; n < 1000; ++n) {
    Block block;
    for (int j = -1; j <= 1; ++j)
      for (int i = -1; i <= 1; ++i) {
        const double q = std::generate_canonical<double, 53>(random);
        for (int k = -1; k <= 1; ++k) block.q(i, j, k) = q;
      }
    EXPECT_NEAR(block.normal().a, block.flat_normal().a, 1e-15);
    EXPECT_NEAR(block.normal().b, block.flat_normal().b, 1e-15);
    EXPECT_EQ(block.normal().c, 0);
  }
}

// Arbitrary values, including ties, mirrored in arbitrary directions.
TEST(InterfaceNormal, HasMirroredBits) {
  std::mt19937_64 random{3};
  for (int n = 0; n < 2000; ++n) {
    Block block, other;
    for (double &q : block.value) {
      const double r = std::generate_canonical<double, 53>(random);
      q = n % 2 ? r : std::round(4 * r) / 4;
    }
    for (int mirror = 1; mirror < 8; ++mirror) {
      const int si = mirror & 1 ? -1 : 1, sj = mirror & 2 ? -1 : 1, sk = mirror & 4 ? -1 : 1;
      for (int k = -1; k <= 1; ++k)
        for (int j = -1; j <= 1; ++j)
          for (int i = -1; i <= 1; ++i) other.q(si * i, sj * j, sk * k) = block.q(i, j, k);
      const InterfaceNormal a = block.normal(), b = other.normal();
      EXPECT_EQ(b.a, si * a.a);
      EXPECT_EQ(b.b, sj * a.b);
      EXPECT_EQ(b.c, sk * a.c);
      const InterfaceNormal c = block.flat_normal(), d = other.flat_normal();
      if (mirror >= 4) continue;
      EXPECT_EQ(d.a, si * c.a);
      EXPECT_EQ(d.b, sj * c.b);
    }
  }
}

}  // namespace
