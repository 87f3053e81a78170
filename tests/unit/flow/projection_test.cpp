// The classic step fuses several equations into one pass over memory; the bits are those of separate passes.
#include "flow/projection.hpp"
#include "flow/correction.hpp"
#include "grid/blocks.hpp"
#include "kernels/momentum.hpp"
#include "support/polynomials.hpp"
#include "support/verbs.hpp"

#include <gtest/gtest.h>

#include <cstring>

using namespace eulastic;
using namespace eulastic::test;

namespace {

struct BoundaryCase {
  bool flat;
  int walls;  // bit d: direction d has walls
};

// A random flow with valid ghosts, and more than one block of rows in y.
struct RandomFlow {
  Domain domain;
  std::unique_ptr<GhostExchange> exchange;
  BoundaryConditions walls{};
  Field velocity, pressure;

  explicit RandomFlow(const BoundaryCase &sides) {
    GridSpec spec = uneven_box(sides.flat, {11, block_rows + 5, 6});
    for (int d = 0; d < 3; ++d)
      if (sides.walls >> d & 1) spec.boundary[d] = Boundary::wall;
    EXPECT_EQ(domain.create(PETSC_COMM_SELF, spec), 0);
    exchange = std::make_unique<GhostExchange>(domain);
    velocity = Field(domain, domain.dimension());
    pressure = Field(domain, 1);
    Random random(5);
    for (int a = 0; a < domain.dimension(); ++a)
      set(domain, velocity[a], at_face[a], [&](double, double, double) { return random(); });
    set(domain, pressure[0], at_centre, [&](double, double, double) { return 2 + random(); });
    EXPECT_EQ(exchange->update_ghosts(velocity, 3), 0);
    fill_wall_ghosts_velocity(domain, walls, 0, velocity, 3);
    fill_centre(pressure);
  }
  void fill_centre(Field &q) {
    EXPECT_EQ(exchange->update_ghosts(q, 1), 0);
    fill_wall_ghosts_even(domain, at_centre, q[0], 1);
  }
};

bool same_rows(const Domain &domain, const Field &a, const Field &b) {
  bool same = true;
  for (int f = 0; f < a.count(); ++f)
    for (const Segment &s : domain.rows())
      same &= std::memcmp(a[f].row(s.j, s.k), b[f].row(s.j, s.k), sizeof(double) * s.size()) == 0;
  return same;
}

class Projection : public ::testing::TestWithParam<BoundaryCase> {};

TEST_P(Projection, IncrementByFormulaHasTheBitsOfAStoredOne) {
  RandomFlow flow(GetParam()), other(GetParam());
  const Domain &domain = flow.domain;
  const double rotation = 0.3;
  const kernels::AcmIncrement formula{0.07, 0.3, 12, 1.9};
  Field D(domain, 1), increment(domain, 1);
  ASSERT_EQ(compute_divergence(domain, 1, flow.velocity, D), 0);
  flow.fill_centre(D);
  for (std::ptrdiff_t i = 0; i < D.layout().size; ++i)
    increment.data()[i] = formula(D.data()[i], flow.pressure.data()[i]);
  ASSERT_EQ(correct_velocity(domain, 1.7, 0.1, rotation, increment, D, flow.velocity, flow.pressure), 0);
  ASSERT_EQ(correct_velocity(domain, 1.7, 0.1, rotation, formula, D, other.velocity, other.pressure), 0);
  EXPECT_TRUE(same_rows(domain, flow.velocity, other.velocity));
  // One ghost of the pressure in every direction.
  const Int3 n = domain.cells();
  const int gz = GetParam().flat ? 0 : 1;
  for (int k = -gz; k < n[2] + gz; ++k)
    for (int j = -1; j < n[1] + 1; ++j)
      EXPECT_EQ(
          std::memcmp(flow.pressure[0].row(j, k) - 1, other.pressure[0].row(j, k) - 1, sizeof(double) * (n[0] + 2)), 0)
          << j << ' ' << k;
}

INSTANTIATE_TEST_SUITE_P(Boxes, Projection,
                         ::testing::Values(BoundaryCase{true, 0}, BoundaryCase{true, 1}, BoundaryCase{true, 2},
                                           BoundaryCase{true, 3}, BoundaryCase{false, 0}, BoundaryCase{false, 1},
                                           BoundaryCase{false, 2}, BoundaryCase{false, 4}, BoundaryCase{false, 7}));

}  // namespace
