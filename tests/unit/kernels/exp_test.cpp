// The exponential is compared with that of libm in long double; its bits do not depend on the vector length.
#include "kernels/exp.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <vector>

using namespace eulastic;

namespace {

constexpr int samples = 200003;

// Returns the difference from `exact` in units of the last place of `exact`.
double ulps(double value, long double exact) {
  const double rounded = std::fabs(static_cast<double>(exact));
  const double unit = std::nextafter(rounded, INFINITY) - rounded;
  return static_cast<double>(std::fabs((value - exact) / unit));
}

double worst_exp(double low, double high) {
  double worst = 0;
  for (int n = 0; n < samples; ++n) {
    const double x = low + (high - low) * n / (samples - 1);
    worst = std::fmax(worst, ulps(kernels::exp(x), std::exp(static_cast<long double>(x))));
  }
  return worst;
}

TEST(Exp, IsWithinOneUnitInTheLastPlace) {
  EXPECT_LT(worst_exp(-7, 7), 1);
  EXPECT_LT(worst_exp(-1e-3, 1e-3), 1);
  EXPECT_LT(worst_exp(-700, 700), 1);
  EXPECT_EQ(kernels::exp(0), 1);
  EXPECT_EQ(kernels::exp(-0.0), 1);
}

EULASTIC_INLINE void all(const double *x, double *e, int n) {
#pragma omp simd
  for (int i = 0; i < n; ++i) e[i] = kernels::exp(x[i]);
}

[[gnu::noinline]] void baseline(const double *x, double *e, int n) { all(x, e, n); }
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__)
[[gnu::noinline, gnu::target("arch=x86-64-v4")]] void wide(const double *x, double *e, int n) { all(x, e, n); }
bool has_wide() { return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq"); }
#else
void wide(const double *x, double *e, int n) { all(x, e, n); }
bool has_wide() { return false; }
#endif

TEST(Exp, HasTheSameBitsInEveryVectorLength) {
  const int n = 4099;
  std::vector<double> x(n), e(n), e2(n);
  for (int i = 0; i < n; ++i) x[i] = -7 + 14.0 * i / n;
  baseline(x.data(), e.data(), n);
  for (int i = 0; i < n; ++i) all(&x[i], &e2[i], 1);
  EXPECT_EQ(std::memcmp(e.data(), e2.data(), n * sizeof(double)), 0);
  if (!has_wide()) GTEST_SKIP() << "no AVX-512 here";
  wide(x.data(), e2.data(), n);
  EXPECT_EQ(std::memcmp(e.data(), e2.data(), n * sizeof(double)), 0);
}

}  // namespace
