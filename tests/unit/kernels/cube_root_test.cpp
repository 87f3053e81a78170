// The cube root is compared with that of libm in long double; its bits do not depend on the vector length.
#include "kernels/plane.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <vector>

using namespace eulastic;

namespace {

TEST(CubeRoot, IsWithin1e14) {
  double worst = 0;
  for (int n = 0; n <= 300000; ++n) {
    const double x = std::pow(10, -200 + n * 1e-3);
    const long double exact = std::cbrt(static_cast<long double>(x));
    worst = std::fmax(worst, static_cast<double>(std::fabs(kernels::cube_root(x) / exact - 1)));
  }
  EXPECT_LT(worst, 1e-14);
}

EULASTIC_INLINE void roots(const double *x, double *y, int n) {
#pragma omp simd
  for (int i = 0; i < n; ++i) y[i] = kernels::cube_root(x[i]);
}

[[gnu::noinline]] void baseline(const double *x, double *y, int n) { roots(x, y, n); }
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__)
[[gnu::noinline, gnu::target("arch=x86-64-v4")]] void wide(const double *x, double *y, int n) { roots(x, y, n); }
bool has_wide() { return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq"); }
#else
void wide(const double *x, double *y, int n) { roots(x, y, n); }
bool has_wide() { return false; }
#endif

TEST(CubeRoot, HasTheSameBitsInEveryVectorLength) {
  const int n = 4099;
  std::vector<double> x(n), y(n), other(n);
  for (int i = 0; i < n; ++i) x[i] = std::pow(10, -40 + 42.0 * i / n);
  baseline(x.data(), y.data(), n);
  for (int i = 0; i < n; ++i) roots(&x[i], &other[i], 1);
  EXPECT_EQ(std::memcmp(y.data(), other.data(), n * sizeof(double)), 0);
  if (!has_wide()) GTEST_SKIP() << "no AVX-512 here";
  wide(x.data(), other.data(), n);
  EXPECT_EQ(std::memcmp(y.data(), other.data(), n * sizeof(double)), 0);
}

}  // namespace
