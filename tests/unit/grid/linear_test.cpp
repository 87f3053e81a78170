// Linear interpolation: exact for linear fields, its slopes too.
#include "grid/linear.hpp"

#include <gtest/gtest.h>

namespace eulastic {
namespace {

TEST(LinearPoints, LinearFieldsAndTheirSlopes) {
  for (const int deep : {1, 6}) {
    DomainShape shape;
    shape.cells = {8, 5, deep};
    shape.length = {4, 3, 2};
    const Box box(shape, {}, shape.cells, 3);
    for (const Staggering &staggering : {at_centre, at_face[0], at_face[1]}) {
      const auto field = [&](const Int3 &at) {
        const Real3 slope{0.7, -1.3, deep > 1 ? 0.4 : 0};
        double value = 2;
        for (int d = 0; d < 3; ++d) value += slope[d] * (at[d] + (staggering[d] ? 0 : 0.5)) * box.spacing()[d];
        return value;
      };
      const Real3 place{1.37, 2.91, 0.61};
      double value = 0, weights = 0;
      Real3 slope{};
      int points = 0;
      LinearPoints(box, staggering, place.data()).for_all([&](const LinearPoints::Point &point) {
        ++points;
        EXPECT_GE(point.weight, 0);
        weights += point.weight;
        value += point.weight * field(point.at);
        for (int d = 0; d < 3; ++d) slope[d] += point.slope[d] * field(point.at);
      });
      EXPECT_EQ(points, deep > 1 ? 8 : 4);
      EXPECT_NEAR(weights, 1, 1e-15);
      EXPECT_NEAR(value, 2 + 0.7 * 1.37 - 1.3 * 2.91 + (deep > 1 ? 0.4 * 0.61 : 0), 1e-13);
      EXPECT_NEAR(slope[0], 0.7, 1e-13);
      EXPECT_NEAR(slope[1], -1.3, 1e-13);
      EXPECT_NEAR(slope[2], deep > 1 ? 0.4 : 0, 1e-13);
    }
  }
}

TEST(LinearPoints, AreKeptWithinLimits) {
  DomainShape shape;
  shape.cells = {8, 8, 1};
  const Box box(shape, {}, shape.cells, 3);
  for (const double x : {-0.3, 0.02, 0.98, 1.4}) {
    const Real3 place{x, 0.5, 0};
    LinearPoints points(box, at_centre, place.data());
    points.keep_between(0, 2, 5);
    double weight = 0, mean = 0;
    points.for_all([&](const LinearPoints::Point &point) {
      EXPECT_GE(point.at[0], 2);
      EXPECT_LE(point.at[0], 5);
      weight += point.weight;
      mean += point.weight * point.at[0];
    });
    EXPECT_NEAR(weight, 1, 1e-15);
    EXPECT_NEAR(mean, x < 0.5 ? 2 : 5, 1e-14) << "the last one";
  }
}

}  // namespace
}  // namespace eulastic
