// B becomes positive definite in the sense of solid_transport.hpp, and does not change where it is.
#include "solids/solid_transport.hpp"
#include "support/all_segments.hpp"
#include "support/polynomials.hpp"
#include "support/verbs.hpp"

#include <gtest/gtest.h>

#include <cmath>

using namespace eulastic;
using namespace eulastic::test;

namespace {

// A body that fills the grid: B = diagonal + shear that is too large on one edge in three.
struct Body {
  Domain domain;
  Phase phase;
  explicit Body(bool flat) {
    EXPECT_EQ(domain.create(PETSC_COMM_SELF, uneven_box(flat)), 0);
    phase.fraction = Field(domain, 1);
    phase.tensor.field = Field(domain, static_cast<int>(tensor_components(domain.dimension()).size()));
    phase.tensor.rule = {0.5, 0.5, 0};
    build_all(domain, &phase.tensor.evolving);
    const Layout &layout = domain.layout();
    for (std::ptrdiff_t p = 0; p < layout.size; ++p) {
      phase.fraction.data()[p] = 1;
      for (int f = 0; f < phase.tensor.field.count(); ++f) {
        const auto [a, b, at] = tensor_components(domain.dimension())[f];
        phase.tensor.field.data()[f * layout.size + p] = a == b ? 4 + a : (p % 3 == 0 ? -9 : 2);
      }
    }
  }
};

}  // namespace

TEST(PositiveDefinite, ShearIsLimitedOnlyWhereItIsTooMuch) {
  for (const bool flat : {true, false}) {
    Body body(flat);
    const std::vector<double> before(
        body.phase.tensor.field.data(),
        body.phase.tensor.field.data() + body.phase.tensor.field.count() * body.domain.layout().size);
    ASSERT_EQ(limit_shear(body.domain, body.phase, body.phase.tensor.field), 0);
    const auto &components = tensor_components(body.domain.dimension());
    const Int3 n = body.domain.cells();
    int limited = 0;
    for (int f = 0; f < body.phase.tensor.field.count(); ++f) {
      const auto [a, b, at] = components[f];
      for (int k = 0; k < n[2]; ++k)
        for (int j = 0; j < n[1]; ++j)
          for (int i = 0; i < n[0]; ++i) {
            const double old = before[f * body.domain.layout().size + body.domain.layout().offset(i, j, k)];
            const double now = body.phase.tensor.field[f](i, j, k);
            if (a != b && old < 0) {
              EXPECT_DOUBLE_EQ(now, -std::sqrt((4. + a) * (4. + b)));
              ++limited;
            } else {
              EXPECT_EQ(now, old);
            }
          }
    }
    EXPECT_GT(limited, 10);
  }
}

TEST(PositiveDefinite, TransportKeepsTheDiagonalAboveZero) {
  Body body(true);
  Field velocity(body.domain, 2), next(body.domain, 3);
  const double h = body.domain.spacing()[0];
  const Layout &layout = body.domain.layout();
  for (std::ptrdiff_t p = 0; p < layout.size; ++p)
    for (int f = 0; f < 3; ++f) body.phase.tensor.field.data()[f * layout.size + p] = f < 2 ? 1 : 0;
  for (int j = -1; j <= body.domain.cells()[1]; ++j)
    for (int i = -3; i <= body.domain.cells()[0] + 1; ++i) velocity[0](i, j, 0) = -i * h;  // du/dx = -1
  ASSERT_EQ(transport_tensor(body.domain, {0.25, false}, velocity, body.phase, body.phase.tensor.field, next), 0);
  EXPECT_NEAR(next[0](2, 1, 0), 0.5, 1e-12);
  ASSERT_EQ(transport_tensor(body.domain, {2, false}, velocity, body.phase, body.phase.tensor.field, next), 0);
  EXPECT_EQ(next[0](2, 1, 0), 0);  // -3 without the limit
}

TEST(PositiveDefinite, WhatIsNotFiniteStaysSo) {
  Body body(true);
  Field velocity(body.domain, 2), next(body.domain, 3);
  for (int j = -3; j <= body.domain.cells()[1] + 1; ++j)
    for (int i = -3; i <= body.domain.cells()[0] + 1; ++i) velocity[0](i, j, 0) = -(i + 8 * j) * 1e200;
  ASSERT_EQ(transport_tensor(body.domain, {1e200, false}, velocity, body.phase, body.phase.tensor.field, next), 0);
  EXPECT_EQ(next[0](2, 1, 0), -INFINITY);
  EXPECT_FALSE(std::isfinite(next[2](2, 1, 0)));
  body.phase.tensor.field[2](1, 1, 0) = INFINITY;
  body.phase.tensor.field[2](2, 1, 0) = -INFINITY;
  ASSERT_EQ(limit_shear(body.domain, body.phase, body.phase.tensor.field), 0);
  EXPECT_EQ(body.phase.tensor.field[2](1, 1, 0), INFINITY);
  EXPECT_EQ(body.phase.tensor.field[2](2, 1, 0), -INFINITY);
}
