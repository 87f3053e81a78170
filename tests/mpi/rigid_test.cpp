// Rigid bodies that reach across ranks and sides, one of them turning into itself or, an ellipsoid, through the grid,
// beside a soft one: the same bits on any number of ranks.
#include "base/rank_zero.hpp"
#include "output/saved_state.hpp"
#include "rigid/rigid_surfaces.hpp"
#include "support/on_one_rank.hpp"
#include "support/rigid_scene.hpp"

#include <gtest/gtest.h>

#include <cstring>

using namespace eulastic;
using namespace eulastic::test;

namespace {

struct Case {
  const char *name;
  MethodKind method;
  PressureKind pressure;
  Int3 cells;
  bool bounded;  // along y
  bool split_x = false, travels = false, turns = false, file = false;
};

void PrintTo(const Case &c, std::ostream *out) { *out << c.name; }

struct End {
  std::uint64_t hash = 0;
  std::vector<RigidLoad> loads;
};

End run(MPI_Comm comm, const Case &c) {
  int size = 0;
  MPI_Comm_size(comm, &size);
  Scene scene;
  GridSpec grid;
  grid.cells = c.cells;
  const bool flat = c.cells[2] == 1;
  for (int d = 0; d < 3; ++d) grid.length[d] = 0.1 * c.cells[d];
  if (c.bounded) grid.boundary[1] = Boundary::wall;
  if (c.split_x) grid.processors = {size, 1, 1};
  SolverSpec spec;
  static_cast<Method &>(spec) = method_preset(c.method);
  spec.pressure = c.pressure;
  spec.fluid.viscosity = 0.1;
  spec.fluid.body_force.force = {1, c.bounded ? 0 : 0.3, 0};
  EXPECT_EQ(scene.create(comm, grid, spec), 0);
  const Real3 &l = grid.length;
  SpeciesSpec rotor = rigid_body(Shape::sphere, 0.45, {0.07, c.bounded ? 0.55 : 0.02, 0.5 * l[2]});
  rotor.motion.angular_velocity = flat ? Real3{0, 0, 2} : Real3{1, -0.5, 2};
  rotor.motion.of_rotation = {3, 0.4};
  if (c.travels) {
    rotor.motion.velocity = {0.9, c.bounded ? 0 : -0.5, flat ? 0 : 0.6};
    rotor.motion.of_velocity = {4, -0.3};
  }
  SpeciesSpec plate;
  plate.shape = Shape::slab;
  plate.axis = 1;
  plate.interval = {l[1] - 0.33, l[1] - 0.06};
  plate.motion.velocity = {0.4, 0, 0};
  if (c.turns) {
    rotor.shape = Shape::ellipsoid;
    rotor.semi_axes = {0.45, 0.25, 0.35};
  }
  if (c.file) rotor.centre = {0.9, 0.95, 0.5 * l[2]};  // of one piece
  add_rigid(&scene, {rotor, plate}, c.file);
  scene.add_phase(0.5, [&](double x, double y, double z) {
    const double r = std::hypot(x - 0.5 * l[0], y - 0.5 * l[1], flat ? 0 : z - 0.5 * l[2]);
    return std::min(1.0, std::max(0.0, 0.5 + (0.35 - r) / 0.1));
  });
  EXPECT_EQ(scene.solver.prepare(), 0);
  EXPECT_EQ(scene.advance(c.travels ? 14 : 6, 0.5), 0);
  End end;
  EXPECT_EQ(state_hash(&scene.solver, &end.hash), 0);
  EXPECT_EQ(scene.solver.rigid_loads(&end.loads), 0);
  EXPECT_EQ(end.loads.size(), 2u);
  EXPECT_NE(end.loads[0].torque[2], 0);
  EXPECT_NE(end.loads[1].force[0], 0);
  return end;
}

class RigidBodies : public testing::TestWithParam<Case> {};

TEST_P(RigidBodies, SameBitsAsOnOneRank) {
  const End all = run(run_communicator(), GetParam());
  const End alone = on_one_rank([&](MPI_Comm comm) { return run(comm, GetParam()); },
                                [](End *end) {
                                  share(&end->hash);
                                  share(&end->loads);
                                });
  EXPECT_EQ(all.hash, alone.hash);
  ASSERT_EQ(alone.loads.size(), all.loads.size());
  for (std::size_t b = 0; b < all.loads.size(); ++b)
    EXPECT_EQ(std::memcmp(&all.loads[b], &alone.loads[b], sizeof all.loads[b]), 0);
}

constexpr MethodKind fast = MethodKind::fast, classic = MethodKind::classic;
constexpr PressureKind acm = PressureKind::acm, smac = PressureKind::smac;
INSTANTIATE_TEST_SUITE_P(Scenes, RigidBodies,
                         testing::Values(Case{"fast_bounded", fast, acm, {18, 20, 14}, true},
                                         Case{"fast_periodic", fast, smac, {18, 20, 14}, false},
                                         Case{"classic_bounded", classic, acm, {18, 20, 14}, true},
                                         Case{"flat_periodic", fast, acm, {23, 21, 1}, false},
                                         Case{"split_x", fast, acm, {1030, 21, 1}, true, true},
                                         Case{"travelling", fast, acm, {18, 20, 14}, true, false, true},
                                         Case{"travelling_flat", fast, smac, {23, 21, 1}, false, false, true},
                                         Case{"turning", fast, acm, {18, 20, 14}, true, false, false, true},
                                         Case{"turning_file", fast, acm, {23, 21, 1}, false, false, true, true, true}),
                         [](const auto &test) { return test.param.name; });

}  // namespace
