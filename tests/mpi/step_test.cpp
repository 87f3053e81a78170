// The same bits on any number of ranks: the state after twenty steps has the hash of the run on one rank.
#include "base/rank_zero.hpp"
#include "output/saved_state.hpp"
#include "support/materials.hpp"
#include "support/on_one_rank.hpp"
#include "support/scene.hpp"

#include <gtest/gtest.h>

using namespace eulastic;
using namespace eulastic::test;

namespace {

struct Case {
  const char *name;
  Int3 cells;
  int walls;  // bit d: walls in direction d
  PressureKind pressure;
  int phases = 1;
  bool split_x = false;
};

void PrintTo(const Case &c, std::ostream *out) { *out << c.name; }

int world_size() {
  int size = 0;
  MPI_Comm_size(run_communicator(), &size);
  return size;
}

// Bodies off the centre, one across the periodic sides; all walls move, one of them to and fro.
std::uint64_t hash_after(MPI_Comm comm, const Case &c, int steps, double force = 0.02) {
  Scene scene;
  GridSpec grid;
  grid.cells = c.cells;
  const Real3 h{0.5, 0.45, 0.55};
  for (int d = 0; d < 3; ++d) {
    grid.length[d] = h[d] * c.cells[d];
    if (c.walls >> d & 1) grid.boundary[d] = Boundary::wall;
  }
  if (comm != PETSC_COMM_SELF && c.split_x) grid.processors = {world_size(), 1, 1};
  SolverSpec spec;
  spec.pressure = c.pressure;
  spec.fluid.density = 1.3;
  spec.fluid.viscosity = 0.3;
  spec.fluid.body_force.force = {force, 0.01, -0.015};
  spec.sides[0][1].motion.velocity = {0, 0.15, 0.05};
  spec.sides[1][1].motion = {{0.2, 0, -0.1}, 2, 0.3};
  spec.sides[2][0].motion.velocity = {-0.1, 0.05, 0};
  EXPECT_EQ(scene.create(comm, grid, spec), 0);
  const bool flat = scene.domain.dimension() == 2;
  const Real3 &L = grid.length;
  for (int a = 0; a < scene.domain.dimension(); ++a)
    set(scene.domain, scene.solver.state().velocity[a], at_face[a],
        [&, b = (a + 1) % (flat ? 2 : 3)](double x, double y, double z) {
          return 0.2 * std::sin(6.283185307179586 * std::array<double, 3>{x, y, z}[b] / L[b]);
        });
  for (int p = 0; p < c.phases; ++p)
    scene.add_phase(0.4 + p, [&](double x, double y, double z) {
      const double centre[3] = {p ? 1.1 : 0.6 * L[0], p ? 0.7 * L[1] : 2.6, p ? 0.3 : 0.55 * L[2]};
      const double q[3] = {x, y, z};
      double r = 0;
      for (int d = 0; d < (flat ? 2 : 3); ++d) {
        double distance = q[d] - centre[d];
        if (!(c.walls >> d & 1)) distance -= L[d] * std::round(distance / L[d]);
        r += distance * distance;
      }
      return std::min(1.0, std::max(0.0, 0.5 + (1.4 - std::sqrt(r)) / 0.5));
    });
  if (c.phases > 1) scene.solver.state().phases[1].material = test::mooney_rivlin(0.3, 0.4, 0.2);
  EXPECT_EQ(scene.solver.prepare(), 0);
  FlowExtremes extremes;
  EXPECT_EQ(scene.solver.measure(&extremes), 0);
  const double dt = 0.8 * scene.solver.limits(extremes).combined;
  EXPECT_EQ(scene.run(steps * dt, steps), 0);
  EXPECT_EQ(scene.solver.measure(&extremes), 0);
  EXPECT_GT(extremes.max_speed(), 1e-2);
  EXPECT_GT(extremes.stiffness, 1.01 * scene.solver.state().phases[0].material.shear_modulus) << "bodies deform";
  EXPECT_EQ(extremes.first_non_finite, -1);
  std::uint64_t hash = 0;
  EXPECT_EQ(state_hash(&scene.solver, &hash), 0);
  return hash;
}

class Step : public ::testing::TestWithParam<Case> {};

TEST_P(Step, SameBitsAsOnOneRank) {
  EXPECT_EQ(hash_after(run_communicator(), GetParam(), 20),
            on_one_rank([](MPI_Comm comm) { return hash_after(comm, GetParam(), 20); }));
}

constexpr PressureKind acm = PressureKind::acm, smac = PressureKind::smac;
INSTANTIATE_TEST_SUITE_P(
    Scenes, Step,
    ::testing::Values(
        Case{"channel_acm", {18, 16, 14}, 2, acm}, Case{"channel_smac", {18, 16, 14}, 2, smac},
        Case{"flat_acm", {23, 19, 1}, 2, acm}, Case{"flat_smac", {23, 19, 1}, 2, smac},
        Case{"duct_acm", {18, 16, 14}, 3, acm}, Case{"duct_smac", {18, 16, 14}, 3, smac},
        Case{"closed_acm", {13, 16, 14}, 7, acm}, Case{"closed_smac", {13, 16, 14}, 7, smac},
        Case{"periodic_acm", {17, 13, 15}, 0, acm}, Case{"periodic_smac", {17, 13, 15}, 0, smac},
        Case{"two_phases_acm", {18, 16, 14}, 2, acm, 2}, Case{"two_phases_smac", {18, 16, 14}, 2, smac, 2},
        Case{"flat_duct_two_phases", {23, 19, 1}, 3, acm, 2}, Case{"split_x_acm", {1030, 9, 1}, 2, acm, 2, true},
        Case{"split_x_smac", {1030, 9, 1}, 3, smac, 2, true}, Case{"split_x_channel", {1030, 5, 4}, 2, acm, 1, true}),
    [](const auto &test) { return test.param.name; });

TEST(StateHash, SeesEveryChange) {
  const Case channel{"", {18, 16, 14}, 2, acm};
  const std::uint64_t reference = hash_after(run_communicator(), channel, 20);
  EXPECT_NE(reference, hash_after(run_communicator(), channel, 21));
  EXPECT_NE(reference, hash_after(run_communicator(), channel, 20, std::nextafter(0.02, 1)));
}

}  // namespace
