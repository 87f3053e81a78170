// Capsules that reach across ranks and walls of the split, and that have to be kept apart: the same bits on any number
// of ranks.
#include "base/rank_zero.hpp"
#include "bodies/fill_phase.hpp"
#include "output/saved_state.hpp"
#include "support/all_bodies.hpp"
#include "support/on_one_rank.hpp"
#include "support/scene.hpp"

#include <gtest/gtest.h>

#include <cstring>

using namespace eulastic;
using namespace eulastic::test;

namespace {

struct Case {
  const char *name;
  Int3 cells;
  kernels::MembraneLaw law;
  double viscosity = 0;
  bool split_x = false;
  double stretch_force = 0;
  double away = 0.6;  ///< the first one from the wall
};

void PrintTo(const Case &c, std::ostream *out) { *out << c.name; }

struct End {
  std::uint64_t hash = 0;
  SurfaceEnergy surface;
  double stretch_power = 0;
  std::vector<SurfaceMeasure> bodies;
};

// Two capsules of two species near each other, one across the periodic x, in shear.
End run(MPI_Comm comm, const Case &c) {
  int size = 0;
  MPI_Comm_size(comm, &size);
  Scene scene;
  GridSpec grid;
  grid.cells = c.cells;
  const bool flat = c.cells[2] == 1;
  for (int d = 0; d < 3; ++d) grid.length[d] = 0.25 * c.cells[d];
  grid.boundary[1] = Boundary::wall;
  if (c.split_x) grid.processors = {size, 1, 1};
  SolverSpec spec;
  static_cast<Method &>(spec) = method_preset(MethodKind::fast);
  spec.pressure = PressureKind::smac;
  spec.fluid.density = 0.1;
  spec.sides[1][1].motion.velocity = {1.5, 0, 0};
  EXPECT_EQ(scene.create(comm, grid, spec), 0);
  set(scene.domain, scene.solver.state().velocity[0], at_face[0],
      [&](double, double y, double) { return 1.5 * y / grid.length[1]; });
  SpeciesSpec capsule;
  capsule.name = "capsule";
  capsule.law = Law::membrane;
  capsule.radius = 1.1;
  if (c.viscosity > 0) capsule.viscosity = c.viscosity;
  capsule.membrane = {c.law, 2, 1.5, 1.1, 0.02, 0.5};
  capsule.stretch_force = {c.stretch_force, 0.1};
  const double z = flat ? 0.125 : grid.length[2] / 2;
  const std::vector<BodyPlace> places{{{0.6, capsule.radius + c.away, z}, {}}, {{3.2, 2.2, z}, {}}};
  for (const std::size_t b : {0, 1}) {
    const std::vector<BodyPlace> place{places[b]};
    capsule.name = b == 0 ? "capsule" : "other";
    Phase phase;
    EXPECT_EQ(fill_phase(scene.domain, capsule, place, static_cast<int>(b) + 1, &phase), 0);
    scene.solver.state().phases.push_back(std::move(phase));
    scene.solver.bodies().add_phase(scene.domain, place);
  }
  EXPECT_EQ(scene.solver.prepare(), 0);
  EXPECT_EQ(scene.advance(12, 2), 0);
  End end;
  EXPECT_EQ(state_hash(&scene.solver, &end.hash), 0);
  std::vector<SurfaceMeasure> owned;
  EXPECT_EQ(scene.solver.surface_energy(&end.surface, &owned), 0);
  EXPECT_EQ(all_bodies(comm, scene.solver.bodies().bodies(), 2, owned, &end.bodies), 0);
  EXPECT_GT(end.surface.energy, 0.01);
  EXPECT_EQ(scene.solver.force_power(&end.stretch_power), 0);
  EXPECT_EQ(end.stretch_power > 0, c.stretch_force > 0);
  return end;
}

class Capsules : public testing::TestWithParam<Case> {};

TEST_P(Capsules, SameBitsAsOnOneRank) {
  const End all = run(run_communicator(), GetParam());
  const End alone = on_one_rank([&](MPI_Comm comm) { return run(comm, GetParam()); },
                                [](End *end) {
                                  share(&end->hash);
                                  share(&end->surface);
                                  share(&end->stretch_power);
                                  share(&end->bodies);
                                });
  EXPECT_EQ(all.hash, alone.hash);
  EXPECT_EQ(std::memcmp(&all.surface, &alone.surface, sizeof all.surface), 0);
  EXPECT_EQ(all.stretch_power, alone.stretch_power);
  ASSERT_EQ(all.bodies.size(), 2u);
  ASSERT_EQ(alone.bodies.size(), 2u);
  EXPECT_EQ(std::memcmp(all.bodies.data(), alone.bodies.data(), 2 * sizeof(SurfaceMeasure)), 0);
  double sum = 0;
  for (const SurfaceMeasure &body : all.bodies) {
    EXPECT_GT(body.area, 0.1);
    EXPECT_GT(body.bending_energy, 0);
    sum += body.shear_energy + body.area_energy + body.bending_energy;
  }
  if (GetParam().away > 0.5)
    EXPECT_NEAR(sum, all.surface.energy, 1e-9 * sum);
  else
    EXPECT_GT(all.surface.energy, 1.01 * sum);  // with that of the film
}

constexpr kernels::MembraneLaw neo_hookean = kernels::MembraneLaw::neo_hookean, skalak = kernels::MembraneLaw::skalak;
INSTANTIATE_TEST_SUITE_P(Scenes, Capsules,
                         testing::Values(Case{"neo_hookean", {22, 17, 14}, neo_hookean},
                                         Case{"skalak_viscous", {22, 17, 14}, skalak, 4},
                                         Case{"flat", {23, 17, 1}, neo_hookean},
                                         Case{"stretched", {22, 17, 14}, skalak, 0, false, 3},
                                         Case{"at_the_wall", {22, 17, 14}, skalak, 0, false, 0, 0.1},
                                         Case{"flat_at_the_wall", {23, 17, 1}, neo_hookean, 0, false, 0, 0.1},
                                         Case{"split_x", {1030, 16, 1}, skalak, 0, true},
                                         Case{"stretched_split_x", {1030, 16, 1}, skalak, 0, true, 3}),
                         [](const auto &test) { return test.param.name; });

}  // namespace
