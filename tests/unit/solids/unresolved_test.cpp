// Unresolved B is repaired, and nothing else changes.
#include "solids/unresolved.hpp"

#include "solids/exterior.hpp"
#include "support/polynomials.hpp"
#include "support/verbs.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <tuple>

using namespace eulastic;
using namespace eulastic::test;

namespace {

constexpr EvolveRule half{0.5, 0.5, 0};

// A body in the lower part of x: B = diag(l, 1/l, 1), turned by 45 degrees in xy, so that det B = 1 at any stretch.
struct Body {
  Domain domain;
  Phase phase;
  explicit Body(bool flat, double l = 50) {
    EXPECT_EQ(domain.create(PETSC_COMM_SELF, uneven_box(flat)), 0);
    phase.fraction = Field(domain, 1);
    phase.tensor.field = Field(domain, static_cast<int>(tensor_components(domain.dimension()).size()));
    const Layout &layout = domain.layout();
    for (std::ptrdiff_t p = 0; p < layout.size; ++p)
      for (int f = 0; f < phase.tensor.field.count(); ++f) {
        const auto [a, b, at] = tensor_components(domain.dimension())[f];
        phase.tensor.field.data()[f * layout.size + p] = a == 2 && b == 2 ? 1
                                                         : a == b         ? 0.5 * (l + 1 / l)
                                                         : a + b == 1     ? 0.5 * (l - 1 / l)
                                                                          : 0;
      }
    fill_everywhere(domain, phase.fraction[0], at_centre,
                    [&](const Point &x) { return x[0] < 0.5 * domain.domain_shape().length[0] ? 1 : 0.4; });
  }
  std::vector<double> values() const {
    return {phase.tensor.field.data(), phase.tensor.field.data() + phase.tensor.field.count() * domain.layout().size};
  }
  long forget(const EvolveRule &rule = half) {
    long count = -1;
    phase.tensor.rule = rule;
    EXPECT_EQ(reset_unresolved(domain, phase, &count), 0);
    return count;
  }
};

}  // namespace

TEST(Unresolved, AnyStretchThatTheGridResolvesIsKept) {
  for (const bool flat : {true, false})
    for (const double l : {1., 5., 1e3, 1e6}) {
      Body body(flat, l);
      const std::vector<double> before = body.values();
      EXPECT_EQ(body.forget(), 0);
      EXPECT_EQ(body.values(), before);
    }
}

TEST(Unresolved, ACentreWithUnlikeNeighboursIsForgotten) {
  for (const bool flat : {true, false}) {
    Body body(flat);
    // Shear that changes its sign at one centre: the mean over its edges vanishes, and det B = (l + 1/l)^2/4.
    const int i = 2, j = 2, k = flat ? 0 : 2;
    const View xy = body.phase.tensor.field[flat ? 2 : 5];
    xy(i, j, k) = -xy(i, j, k);
    xy(i + 1, j + 1, k) = -xy(i + 1, j + 1, k);
    const std::vector<double> before = body.values();
    const Layout &layout = body.domain.layout();
    std::vector<double> want = before;
    int centres = 0;
    for (int dj = -2; dj <= 2;
         ++dj)  // those that see one of the two edges have half of the mean: det B is too large as well
      for (int di = -2; di <= 2; ++di) {
        const std::ptrdiff_t p = layout.offset(i + di, j + dj, k);
        const double *q = before.data() + (flat ? 2 : 5) * layout.size + p;
        const double mean = 0.25 * (q[0] + q[1] + q[layout.sy] + q[layout.sy + 1]);
        if (before[p] * before[p] - mean * mean < 2 * largest_determinant) continue;
        ++centres;
        for (int f = 0; f < body.phase.tensor.field.count(); ++f) {
          const auto [a, b, at] = tensor_components(body.domain.dimension())[f];
          double *B = want.data() + f * layout.size + p;
          if (a == b)
            *B = 1;
          else
            for (const std::ptrdiff_t x : {std::ptrdiff_t{0}, layout.offset(1, 0, 0) - layout.offset(0, 0, 0)})
              for (const std::ptrdiff_t y : {std::ptrdiff_t{0}, layout.sy})
                for (const std::ptrdiff_t z : {std::ptrdiff_t{0}, layout.sz})
                  if ((x == 0 || a == 0 || b == 0) && (y == 0 || a == 1 || b == 1) && (z == 0 || a == 2 || b == 2))
                    B[x + y + z] = 0;
        }
      }
    EXPECT_EQ(centres, 7);
    const long count = body.forget();
    const std::vector<double> after = body.values();
    // Centres around these have lost part of their off-diagonals (yz = xz = 0); their diagonals get one factor such
    // that det B = 1.
    const int dimension = body.domain.dimension();
    const Int3 n = body.domain.cells();
    for (int c = 0; c < n[2]; ++c)
      for (int b = 0; b < n[1]; ++b)
        for (int a = 0; a < n[0]; ++a) {
          const std::ptrdiff_t p = layout.offset(a, b, c);
          const auto determinant = [&](const std::vector<double> &B) {
            const double *q = B.data() + (flat ? 2 : 5) * layout.size + p;
            const double mean = 0.25 * (q[0] + q[1] + q[layout.sy] + q[layout.sy + 1]);
            return (B[p] * B[layout.size + p] - mean * mean) * (flat ? 1 : B[2 * layout.size + p]);
          };
          if (body.phase.fraction[0](a, b, c) < 1 || determinant(want) <= largest_determinant) continue;
          ++centres;
          EXPECT_NEAR(determinant(after), 1, 1e-9);  // of xx yy = 625
          for (int d = 0; d < dimension; ++d) {
            double &B = want[d * layout.size + p];
            EXPECT_NEAR(after[d * layout.size + p] / B, after[p] / before[p], 1e-14);
            B = after[d * layout.size + p];
          }
        }
    EXPECT_GT(centres, 7);
    EXPECT_EQ(count, centres);
    EXPECT_EQ(after, want);
  }
}

TEST(Unresolved, OnlyWhereBEvolvesAndWhatIsNotFiniteStays) {
  Body body(true);
  const Int3 n = body.domain.cells();
  body.phase.tensor.field[0](n[0] - 1, 1, 0) = 1e9;  // outside
  body.phase.tensor.field[0](1, 1, 0) = NAN;
  EXPECT_EQ(body.forget(), 0);
  EXPECT_EQ(body.phase.tensor.field[0](n[0] - 1, 1, 0), 1e9);
  EXPECT_TRUE(std::isnan(body.phase.tensor.field[0](1, 1, 0)));
}

TEST(Unresolved, CellsAtTheSurfaceHaveMoreRoom) {
  Body body(true, 1);
  const View phi = body.phase.fraction[0], xx = body.phase.tensor.field[0];
  for (const auto &[fraction, determinant, count] : {std::tuple{1., 3.4, 0L},
                                                     {1., 3.6, 1L},
                                                     {0.9, 3.6, 0L},
                                                     {0.9, 7.9, 0L},
                                                     {0.9, 8.1, 1L},
                                                     {0.4, 29., 0L},
                                                     {0.4, 31., 1L}}) {
    phi(1, 1, 0) = fraction;
    xx(1, 1, 0) = determinant;
    EXPECT_EQ(body.forget(reset_below_one_per_cent), count) << fraction << " " << determinant;
  }
}

TEST(Unresolved, WhereBIsExtendedDiagonalsAreScaled) {
  for (const bool flat : {true, false})
    for (const double fraction : {1., .6}) {
      Body body(flat, 3);
      const int k = flat ? 0 : 2, dimension = body.domain.dimension();
      for (int d = 0; d < dimension; ++d)
        body.phase.tensor.field[d](2, 2, k) *= 2;  // det B = 4 (3 + 1/3)^2/4 - (3 - 1/3)^2/4
      body.phase.fraction[0](2, 2, k) = fraction;
      const std::vector<double> before = body.values();
      std::vector<double> want = before;
      const std::ptrdiff_t p = body.domain.layout().offset(2, 2, k), size = body.domain.layout().size;
      EXPECT_EQ(body.forget(evolve_above_half), 1);
      const std::vector<double> after = body.values();
      const double xx = after[p], xy = after[(flat ? 2 : 5) * size + p], zz = flat ? 1 : after[2 * size + p];
      EXPECT_NEAR((xx * xx - xy * xy) * zz, 1, 1e-12);
      for (int d = 0; d < dimension; ++d) want[d * size + p] *= xx / before[p];
      for (std::size_t q = 0; q < want.size(); ++q) ASSERT_NEAR(after[q], want[q], 1e-14) << q;  // the edges too
      body.phase.fraction[0](2, 2, k) = 0.4;
      for (int d = 0; d < dimension; ++d) body.phase.tensor.field[d](2, 2, k) = 9;
      EXPECT_EQ(body.forget(evolve_above_half), 0);
    }
}

TEST(Unresolved, TheTraceTellsWhereToLook) {
  const double d = largest_determinant;
  EXPECT_TRUE(may_be_unresolved(2 * std::sqrt(d) + 1, 2));  // B = sqrt(d) I in the plane
  EXPECT_TRUE(may_be_unresolved(3 * std::cbrt(d), 3));
  EXPECT_TRUE(may_be_unresolved(100 + d / 100 + 1, 2));
  EXPECT_FALSE(may_be_unresolved(1.9 * std::sqrt(d) + 1, 2));
  EXPECT_FALSE(may_be_unresolved(2.9 * std::cbrt(d), 3));
  EXPECT_FALSE(may_be_unresolved(3, 2));
}
