// Least-squares fits of quadratics over a plane, and interpolation from four points.
#include "kernels/surface_fit.hpp"

#include <gtest/gtest.h>

#include <cmath>

using namespace eulastic::kernels;

namespace {

double scattered(int n, double a) { return std::fmod(n * a, 2.0) - 1; }

TEST(SurfaceFit, FindsAQuadraticAndWhatIsNot) {
  const double exact[6] = {0.3, -1.1, 0.7, 0.25, -0.4, 0.9};
  for (const double off : {0.0, 1e-2}) {
    SurfacePoints<4> points;
    for (int n = 0; n < 21; ++n) {
      const double u = scattered(n, 0.7548776662), v = scattered(n, 0.5698402909);
      const double f[6] = {1, u, v, u * u, u * v, v * v};
      points.u[n] = u;
      points.v[n] = v;
      points.weight[n] = 1 - 0.3 * u * u;
      for (int q = 0; q < 4; ++q) {
        points.value[q][n] = off * (n % 2 == 0 ? 1 : -1);
        for (int t = 0; t < 6; ++t) points.value[q][n] += (q + 1) * exact[t] * f[t];
      }
    }
    points.count = 21;
    points.pad_to_lanes();
    EXPECT_EQ(points.count, 24);
    SurfaceFit<3, 4> fit;
    ASSERT_TRUE((fit_surface<3, 4>(points, &fit)));
    for (int q = 0; q < 4; ++q)
      for (int t = 0; t < 6; ++t) EXPECT_NEAR(fit.coefficient[t][q], (q + 1) * exact[t], off > 0 ? 0.02 : 1e-12);
    EXPECT_NEAR(std::sqrt(fit.residual / 3), off, off > 0 ? 0.3 * off : 1e-7);
  }
}

TEST(SurfaceFit, RefusesPointsOnALine) {
  SurfacePoints<3> points;
  for (int n = 0; n < 16; ++n) {
    points.u[n] = scattered(n, 0.7548776662);
    points.v[n] = 2 * points.u[n];
    points.weight[n] = 1;
    for (auto &value : points.value) value[n] = points.u[n];
  }
  points.count = 16;
  SurfaceFit<3, 3> fit;
  EXPECT_FALSE((fit_surface<3, 3>(points, &fit)));
}

TEST(SurfaceFit, InTwoDimensionsFitsAParabola) {
  SurfacePoints<2> points;
  for (int n = 0; n < 9; ++n) {
    const double u = -1 + 0.25 * n;
    points.u[n] = u;
    points.v[n] = 0;
    points.weight[n] = 1 - 0.5 * u * u;
    points.value[0][n] = 2 - u + 3 * u * u;
    points.value[1][n] = u;
  }
  points.count = 9;
  points.pad_to_lanes();
  SurfaceFit<2, 2> fit;
  ASSERT_TRUE((fit_surface<2, 2>(points, &fit)));
  EXPECT_NEAR(fit.coefficient[0][0], 2, 1e-13);
  EXPECT_NEAR(fit.coefficient[1][0], -1, 1e-13);
  EXPECT_NEAR(fit.coefficient[2][0], 3, 1e-13);
  EXPECT_NEAR(fit.coefficient[1][1], 1, 1e-13);
}

TEST(SurfaceFit, FourPointsGiveWhatIsQuadratic) {
  for (const double place : {0.0, 0.1, 0.37, 0.5, 0.93}) {
    double sum = 0, moment = 0, square = 0;
    for (int m = -1; m <= 2; ++m) {
      sum += keys4(place - m);
      moment += keys4(place - m) * m;
      square += keys4(place - m) * m * m;
    }
    EXPECT_NEAR(sum, 1, 1e-14);
    EXPECT_NEAR(moment, place, 1e-14);
    EXPECT_NEAR(square, place * place, 1e-14);
  }
  EXPECT_NEAR(keys4(1 + 1e-9), keys4(1 - 1e-9), 1e-8);
  EXPECT_EQ(keys4(2.5), 0);
}

TEST(SurfaceFit, InverseInAPlane) {
  const Vector<3> n{2. / 3, -1. / 3, 2. / 3};
  const auto t = tangents<3>(n);
  for (int a = 0; a < 2; ++a)
    for (int b = 0; b < 2; ++b) {
      double dot = 0, across = 0;
      for (int d = 0; d < 3; ++d) {
        dot += t[a][d] * t[b][d];
        across += t[a][d] * n[d];
      }
      EXPECT_NEAR(dot, a == b, 1e-15);
      EXPECT_NEAR(across, 0, 1e-15);
    }
  const double G[2][2] = {{2, 0.5}, {0.5, 1}}, det = 1.75;
  const Tensor<3> B = inverse_in_plane<3>(t, G);
  const double expected[2][2] = {{1 / det, -0.5 / det}, {-0.5 / det, 2 / det}};
  for (int a = 0; a < 2; ++a)
    for (int b = 0; b < 2; ++b) {
      double found = 0;
      for (int x = 0; x < 3; ++x)
        for (int y = 0; y < 3; ++y) found += t[a][x] * B[x][y] * t[b][y];
      EXPECT_NEAR(found, expected[a][b], 1e-15);
    }
}

}  // namespace
