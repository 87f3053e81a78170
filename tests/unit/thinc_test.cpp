// THINC/SW's flux against quadrature and its limits; the normal; mirrored rows.
#include "kernels/thinc.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

using namespace eulastic;
using kernels::thinc_flux;

namespace {

// Integral of (1 + alpha tanh(beta (x - x0)))/2 over a <= x <= b.
long double profile_integral(long double alpha, long double beta, long double x0, long double a, long double b) {
  long double sum = 0;
  const int pieces = 64;
  const long double node[3] = {-0.774596669241483377L, 0, 0.774596669241483377L},
                    weight[3] = {5 / 9.L, 8 / 9.L, 5 / 9.L};
  for (int p = 0; p < pieces; ++p)
    for (int g = 0; g < 3; ++g) {
      const long double x = a + (b - a) * (p + 0.5L * (1 + node[g])) / pieces;
      sum += weight[g] * (1 + alpha * std::tanh(beta * (x - x0))) / 2;
    }
  return sum * (b - a) / (2 * pieces);
}

// What the profile with mean phi has in the last `courant` of the cell.
double flux_by_quadrature(double phi, double slope, double courant) {
  const long double alpha = slope > 0 ? 1 : -1, beta = kernels::steepness * std::fabs(slope);
  long double low = -400, high = 400;  // of x0
  for (int n = 0; n < 200; ++n) {
    const long double middle = (low + high) / 2;
    (alpha * (profile_integral(alpha, beta, middle, 0, 1) - phi) > 0 ? low : high) = middle;
  }
  return static_cast<double>(profile_integral(alpha, beta, low, 1 - static_cast<long double>(courant), 1));
}

TEST(ThincFlux, IsTheIntegralOfTheProfile) {
  for (const double phi : {2e-5, 1e-3, 0.1, 0.5, 0.7, 0.999, 1 - 2e-5})
    for (const double slope : {0.02, 0.1, 0.5, 1.0})
      for (const double courant : {1e-6, 0.01, 0.25, 0.5, 1.0})
        for (const double sign : {-1.0, 1.0})
          EXPECT_NEAR(thinc_flux(phi, sign * slope, courant), flux_by_quadrature(phi, sign * slope, courant),
                      2e-13 / slope)
              << phi << " " << sign * slope << " " << courant;
}

class RandomCells : public ::testing::Test {
protected:
  std::mt19937_64 random{7};
  double uniform(double low, double high) { return low + (high - low) * std::generate_canonical<double, 53>(random); }
  // Often next to 0 or 1.
  double any_phi() {
    const double q = uniform(0, 1), small = std::pow(10, uniform(-18, 0));
    return q < 0.4 ? uniform(0, 1) : q < 0.7 ? small : 1 - small;
  }
};

TEST_F(RandomCells, TakeNoMoreThanThereIs) {
  for (int n = 0; n < 100000; ++n) {
    const double phi = any_phi(), slope = uniform(-1, 1), courant = uniform(0, 1);
    const double flux = thinc_flux(phi, slope, courant);
    EXPECT_GE(flux, 0);
    EXPECT_LE(flux, std::min(phi, courant));
    EXPECT_GE(flux, courant - (1 - phi));
  }
}

// Fluid and solid change places; and both ends of the cell together give all of it.
TEST_F(RandomCells, AddUp) {
  for (int n = 0; n < 100000; ++n) {
    const double phi = any_phi(), slope = uniform(-1, 1), courant = uniform(0, 1);
    EXPECT_NEAR(thinc_flux(phi, slope, courant) + thinc_flux(1 - phi, -slope, courant), courant, 1e-13);
    EXPECT_NEAR(thinc_flux(phi, slope, courant) + thinc_flux(phi, -slope, 1 - courant), phi, 1e-13);
  }
}

TEST_F(RandomCells, GiveExactlyNothingOrEverythingWhenPure) {
  for (int n = 0; n < 10000; ++n) {
    const double slope = n % 10 == 0 ? 0 : uniform(-1, 1), courant = uniform(0, 1);
    EXPECT_EQ(thinc_flux(0, slope, courant), 0);
    EXPECT_EQ(thinc_flux(1, slope, courant), courant);
    EXPECT_EQ(thinc_flux(any_phi(), slope, 0), 0);
  }
}

// Tails: a nearly empty cell hands on all it has towards the body and nothing away from it, a nearly full one likewise.
TEST(ThincFlux, LeavesNoTails) {
  EXPECT_EQ(thinc_flux(1e-6, 0.5, 0.1), 1e-6);
  EXPECT_EQ(thinc_flux(1e-6, -0.5, 0.1), 0);
  EXPECT_EQ(thinc_flux(1 - 1e-6, 0.5, 0.1), 0.1);
  EXPECT_EQ(thinc_flux(1 - 1e-6, -0.5, 0.1), 0.1 - (1 - (1 - 1e-6)));
}

// A slope that is only round-off must not matter: an interface along the flow stays as it is.
TEST(ThincFlux, BecomesUniformSmoothly) {
  for (const double phi : {1e-7, 0.3, 0.9, 1 - 1e-7}) {
    EXPECT_EQ(thinc_flux(phi, 0, 0.2), 0.2 * phi);
    EXPECT_NEAR(thinc_flux(phi, 1e-15, 0.2), 0.2 * phi, 1e-15);
    EXPECT_NEAR(thinc_flux(phi, -1e-15, 0.2), 0.2 * phi, 1e-15);
    const double threshold = kernels::steepness_min / kernels::steepness;
    EXPECT_NEAR(thinc_flux(phi, threshold * (1 - 1e-12), 0.2), thinc_flux(phi, threshold * (1 + 1e-12), 0.2), 1e-13);
  }
}

TEST(ThincFlux, TendsToTheFaceValue) {
  const double slope = 0.8, beta = kernels::steepness * slope, phi = 0.6;
  const double A = std::exp(beta * (2 * phi - 1)), T = (std::cosh(beta) - A) / std::sinh(beta);  // T = tanh(beta x0)
  const double at_face = (1 + std::tanh(beta - std::atanh(T))) / 2;
  for (const double courant : {1e-3, 1e-5, 1e-7})
    EXPECT_NEAR(thinc_flux(phi, slope, courant) / courant, at_face, courant + 1e-15 / courant);
}

constexpr int n = 21;

struct Rows {
  double phi[n + 2], slope[n + 2], velocity[n + 2], flux[n + 2], next[n + 2], solid[n + 2];
};

// One sweep along x of cells 1 ... n - 1 with the kernels.
void sweep(Rows &r, double rate) {
  const auto view = [](double *row) { return View{row, 0, 0}; };
  const Segment faces{1, n + 1, 0, 0}, inner{1, n, 0, 0};
  kernels::interface_flux(faces, view(r.phi), view(r.slope), view(r.velocity), 1, rate, r.flux);
  std::copy(r.phi, r.phi + n + 2, r.next);
  kernels::apply_flux(inner, view(r.flux), view(r.velocity), view(r.solid), 1, rate, r.next);
}

TEST_F(RandomCells, HaveMirroredBitsWhenMirrored) {
  Rows a, b;
  for (int i = 0; i < n + 2; ++i) {
    a.phi[i] = any_phi();
    a.slope[i] = i % 5 == 0 ? 0.0 : uniform(-1, 1);
    a.velocity[i] = uniform(-1, 1);
    a.solid[i] = a.phi[i] > 0.5;
  }
  for (int i = 0; i <= n; ++i) {
    b.phi[i] = a.phi[n - i];
    b.slope[i] = 0.0 - a.slope[n - i];
    b.solid[i] = a.solid[n - i];
    b.velocity[i] = -a.velocity[n + 1 - i];  // face i is left of cell i
  }
  b.velocity[n + 1] = -a.velocity[0];
  sweep(a, 0.24);
  sweep(b, 0.24);
  for (int i = 1; i < n; ++i) EXPECT_EQ(a.next[i], b.next[n - i]) << i;
}

// Undivided differences: the normal of a linear field in cells of unit size, in both dimensions.
TEST(InterfaceSlope, IsExactForAPlane) {
  double q[5 * 5 * 5], out[5];
  const double g[3] = {0.3, -0.5, 0.2};
  for (int k = 0; k < 5; ++k)
    for (int j = 0; j < 5; ++j)
      for (int i = 0; i < 5; ++i) q[i + 5 * j + 25 * k] = 0.1 + g[0] * i + g[1] * j + g[2] * k;
  const ConstView phi{q, 5, 25};
  const std::ptrdiff_t strides[3] = {1, 5, 25};
  const double flat = std::hypot(g[0], g[1]), full = std::hypot(g[0], g[1], g[2]);
  for (int d = 0; d < 3; ++d) {
    const std::ptrdiff_t turned[3] = {strides[d], strides[(d + 1) % 3], strides[(d + 2) % 3]};
    kernels::interface_slope<3>({1, 4, 2, 2}, phi, turned, out);
    EXPECT_NEAR(out[2], g[d] / full, 1e-15);
  }
  for (int d = 0; d < 2; ++d) {
    const std::ptrdiff_t turned[3] = {strides[d], strides[1 - d], 0};
    kernels::interface_slope<2>({1, 4, 2, 2}, phi, turned, out);
    EXPECT_NEAR(out[2], g[d] / flat, 1e-15);
  }
  const double same[9] = {1, 1, 1, 1, 1, 1, 1, 1, 1};
  const std::ptrdiff_t three[3] = {1, 3, 0};
  kernels::interface_slope<2>({1, 2, 1, 0}, ConstView{same, 3, 0}, three, out);
  EXPECT_EQ(out[1], 0);
}

}  // namespace
