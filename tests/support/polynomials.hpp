// Fields filled ghosts included, random polynomials and repeatable random numbers, for tests of kernels.
#pragma once

#include "support/scene.hpp"

#include <gtest/gtest.h>

#include <random>

namespace eulastic::test {

/// Repeatable numbers in (-1, 1).
class Random {
public:
  explicit Random(int seed) : engine_(seed) {}
  double operator()() { return std::uniform_real_distribution<double>(-1, 1)(engine_); }

private:
  std::mt19937_64 engine_;
};

using Point = std::array<double, 3>;

/// c + g.x + x.h.x/2, h symmetric; `degree` 0, 1 or 2.
struct Polynomial {
  double c = 0;
  Point g{};
  std::array<Point, 3> h{};

  Polynomial() = default;
  Polynomial(Random &random, int degree) : c(random()) {
    for (int a = 0; a < 3; ++a) {
      if (degree > 0) g[a] = random();
      for (int b = 0; b <= a; ++b)
        if (degree > 1) h[a][b] = h[b][a] = random();
    }
  }
  double operator()(const Point &x) const {
    double sum = c;
    for (int a = 0; a < 3; ++a) {
      sum += g[a] * x[a];
      for (int b = 0; b < 3; ++b) sum += 0.5 * x[a] * h[a][b] * x[b];
    }
    return sum;
  }
  double slope(int a, const Point &x) const { return g[a] + h[a][0] * x[0] + h[a][1] * x[1] + h[a][2] * x[2]; }
  double laplacian(int dimension) const { return h[0][0] + h[1][1] + (dimension == 3 ? h[2][2] : 0.0); }
};

inline Point point(const Domain &domain, const Staggering &at, int i, int j, int k) {
  return {position(domain, 0, at[0], i), position(domain, 1, at[1], j), position(domain, 2, at[2], k)};
}

/// Sets a field to value(Point), three ghosts included.
template <class Value>
void fill_everywhere(const Domain &domain, View view, const Staggering &at, Value &&value) {
  const Layout &layout = domain.layout();
  for (int k = -layout.ghosts[2]; k < layout.cells[2] + layout.ghosts[2]; ++k)
    for (int j = -layout.ghosts[1]; j < layout.cells[1] + layout.ghosts[1]; ++j)
      for (int i = -layout.ghosts[0]; i < layout.cells[0] + layout.ghosts[0]; ++i)
        view(i, j, k) = value(point(domain, at, i, j, k));
}

/// Largest |field - exact(Point)| over the points of this rank; NaN counts as infinite.
template <class Exact>
double largest_error(const Domain &domain, ConstView view, const Staggering &at, Exact &&exact) {
  double largest = 0;
  for_points(domain, view, at, [&](const double &q, double x, double y, double z) {
    const double e = std::fabs(q - exact(Point{x, y, z}));
    largest = e <= largest ? largest : std::isfinite(e) ? e : INFINITY;
  });
  return largest;
}

/// Random values at all points, then periodic ghosts (no walls).
inline void randomise(const Domain &domain, Field &block, Random &random, double mean = 0) {
  for (int f = 0; f < block.count(); ++f)
    set(domain, block[f], at_centre, [&](double, double, double) { return mean + random(); });
  GhostExchange exchange(domain);
  EXPECT_EQ(exchange.update_ghosts(block, domain.spec().ghosts), 0);
}

/// 3-D (or 2-D) periodic box with three different spacings.
inline GridSpec uneven_box(bool flat, const Int3 &cells = {11, 6, 5}) {
  GridSpec spec;
  spec.cells = cells;
  spec.length = {1.1, 0.9, 1.3};
  if (flat) spec.cells[2] = 1;
  return spec;
}

}  // namespace eulastic::test
