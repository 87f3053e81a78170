// The upwind difference of fifth order is exact for polynomials of fifth degree, upwind, and its own mirror image.
#include "kernels/weno5.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

using eulastic::kernels::upwind5_difference;

TEST(Upwind5, IsExactForTheFifthDegreeAndUpwind) {
  for (const int stride : {1, 7})
    for (const double velocity : {0.3, -2.0}) {
      std::vector<double> q(6 * stride + 1);
      const auto difference = [&] { return upwind5_difference(&q[3 * stride], stride, velocity); };
      for (int degree = 0; degree <= 5; ++degree) {
        const double at = 0.4;
        for (int m = -3; m <= 3; ++m) q[(m + 3) * stride] = std::pow(at + m, degree);
        EXPECT_NEAR(difference(), degree == 0 ? 0 : degree * std::pow(at, degree - 1), 1e-12) << degree;
      }
      const double before = difference();
      q[velocity > 0 ? 6 * stride : 0] += 1;  // the point that is furthest downwind
      EXPECT_EQ(difference(), before);
      q[velocity > 0 ? 0 : 6 * stride] += 1;
      EXPECT_NE(difference(), before);
    }
}

TEST(Upwind5, MirroredValuesGiveTheMirroredDifference) {
  const double q[] = {0.1, 1.7, -0.3, 2.2, 0.9, -1.4, 0.6};
  double mirrored[7];
  for (int m = 0; m < 7; ++m) mirrored[m] = q[6 - m];
  EXPECT_EQ(upwind5_difference(q + 3, 1, 0.5), -upwind5_difference(mirrored + 3, 1, -0.5));
}
