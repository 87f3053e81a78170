// Drops that reach across ranks, walls and planes of symmetry: the same bits on any number of ranks.
#include "base/rank_zero.hpp"
#include "output/saved_state.hpp"
#include "support/on_one_rank.hpp"
#include "support/scene.hpp"

#include <gtest/gtest.h>

#include <cstring>

using namespace eulastic;
using namespace eulastic::test;

namespace {

struct Case {
  const char *name;
  MethodKind method;
  Int3 cells;
  bool bounded;  // along y and z, high z a plane of symmetry; else periodic throughout
  bool split_x = false;
};

void PrintTo(const Case &c, std::ostream *out) { *out << c.name; }

struct End {
  std::uint64_t hash = 0;
  SurfaceEnergy surface;
};

// One drop without elasticity and one with, each beside a side; the former is more viscous where the scene is flat.
End run(MPI_Comm comm, const Case &c) {
  int size = 0;
  MPI_Comm_size(comm, &size);
  Scene scene;
  GridSpec grid;
  grid.cells = c.cells;
  const bool flat = c.cells[2] == 1;
  for (int d = 0; d < 3; ++d) grid.length[d] = 0.5 * c.cells[d];
  if (c.bounded) grid.boundary[1] = Boundary::wall;
  if (c.bounded && !flat) grid.boundary[2] = Boundary::wall;
  if (c.split_x) grid.processors = {size, 1, 1};
  SolverSpec spec;
  static_cast<Method &>(spec) = method_preset(c.method);
  spec.pressure = PressureKind::smac;
  spec.fluid.density = 1.3;
  spec.fluid.viscosity = 0.3;
  spec.sides[2][1].kind = BoundaryKind::symmetry;
  EXPECT_EQ(scene.create(comm, grid, spec), 0);
  const auto ball = [&](Real3 centre, double radius) {
    if (flat) centre[2] = 0.25;
    return [=, &grid](double x, double y, double z) {
      Real3 r{x - centre[0], y - centre[1], z - centre[2]};
      for (int d = 0; d < 3; ++d)
        if (grid.boundary[d] == Boundary::periodic) r[d] -= grid.length[d] * std::round(r[d] / grid.length[d]);
      const double distance = std::sqrt(r[0] * r[0] + 1.2 * r[1] * r[1] + 0.8 * r[2] * r[2]);
      return std::min(1.0, std::max(0.0, 0.5 + (radius - distance) / 0.5));
    };
  };
  Phase &drop = scene.add_phase(0, ball({2.6, 0.9, 2.7}, 1.7));
  drop.material.surface_tension = 0.8;
  if (flat) drop.material.viscosity = 1.2;
  scene.add_phase(0.3, ball({6.2, 0.6 * grid.length[1], grid.length[2] - 0.7}, 1.5)).material.surface_tension = 0.3;
  EXPECT_EQ(scene.solver.prepare(), 0);
  EXPECT_EQ(scene.advance(8, 0.5), 0);
  End end;
  EXPECT_EQ(state_hash(&scene.solver, &end.hash), 0);
  EXPECT_EQ(scene.solver.surface_energy(&end.surface), 0);
  EXPECT_GT(end.surface.energy, 1);
  EXPECT_LT(end.surface.power, 0);  // they become rounder
  return end;
}

class Drops : public testing::TestWithParam<Case> {};

TEST_P(Drops, SameBitsAsOnOneRank) {
  const End all = run(run_communicator(), GetParam());
  const End alone = on_one_rank([](MPI_Comm comm) { return run(comm, GetParam()); });
  EXPECT_EQ(all.hash, alone.hash);
  EXPECT_EQ(std::memcmp(&all.surface, &alone.surface, sizeof all.surface), 0);
}

constexpr MethodKind fast = MethodKind::fast;
INSTANTIATE_TEST_SUITE_P(Scenes, Drops,
                         testing::Values(Case{"fast_bounded", fast, {18, 16, 14}, true},
                                         Case{"fast_periodic", fast, {18, 16, 14}, false},
                                         Case{"flat_bounded", fast, {23, 19, 1}, true},
                                         Case{"flat_periodic", fast, {23, 19, 1}, false},
                                         Case{"split_x", fast, {1030, 9, 1}, false, true}),
                         [](const auto &test) { return test.param.name; });

}  // namespace
