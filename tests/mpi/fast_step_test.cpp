// -method fast: the same bits on any ranks, with moving and anchored bodies, walls, two phases, both pressure solvers.
#include "base/rank_zero.hpp"
#include "output/saved_state.hpp"
#include "support/on_one_rank.hpp"
#include "support/scene.hpp"

#include <gtest/gtest.h>

using namespace eulastic;
using namespace eulastic::test;

namespace {

std::uint64_t hash_at(Scene &scene, double end, int steps) {
  EXPECT_EQ(scene.solver.prepare(), 0);
  EXPECT_EQ(scene.run(end, steps), 0);
  std::uint64_t hash = 0;
  EXPECT_EQ(state_hash(&scene.solver, &hash), 0);
  return hash;
}

// Hash after some steps of a channel with a moving upper wall, a slab on the lower wall and an off-centre sphere.
std::uint64_t run_hash(MPI_Comm comm, const Int3 &cells, PressureKind pressure, const Int3 &processors) {
  Scene scene;
  GridSpec grid;
  grid.cells = cells;
  grid.length = {1.2, 1, 0.9};
  grid.boundary[1] = Boundary::wall;
  grid.processors = processors;
  SolverSpec spec;
  static_cast<Method &>(spec) = method_preset(MethodKind::fast);
  spec.pressure = pressure;
  spec.sides[1][1].motion.velocity = {1, 0, 0};
  spec.fluid.body_force.force = {1, 0, 0};
  EXPECT_EQ(scene.create(comm, grid, spec), 0);
  const double h = scene.domain.spacing()[1];
  const bool flat = scene.domain.dimension() == 2;
  scene.add_phase(
      2, [=](double, double y, double) { return std::min(1.0, std::max(0.0, (0.33 - (y - h / 2)) / h)); }, true);
  scene.add_phase(1, [=](double x, double y, double z) {
    const double r = std::hypot(x - 0.5, y - 0.62, flat ? 0 : z - 0.4);
    return std::min(1.0, std::max(0.0, 0.5 - (r - 0.22) / h));
  });
  if (pressure == PressureKind::smac)  // both laws
    for (Phase &phase : scene.solver.state().phases)
      phase.material.law = Law::mooney_rivlin, phase.material.c1 = 0.3, phase.material.c2 = 0.2,
      phase.material.c3 = 0.1;
  return hash_at(scene, 0.3, 15);
}

TEST(FastStep, SameBitsOnAnyRanks) {
  int ranks = 1;
  MPI_Comm_size(run_communicator(), &ranks);
  for (const Int3 cells : {Int3{24, 20, 1}, Int3{18, 16, 14}})
    for (const PressureKind pressure : {PressureKind::acm, PressureKind::smac}) {
      const std::uint64_t one = on_one_rank([&](MPI_Comm comm) { return run_hash(comm, cells, pressure, {0, 0, 0}); });
      EXPECT_EQ(run_hash(run_communicator(), cells, pressure, {0, 0, 0}), one);
      EXPECT_EQ(run_hash(run_communicator(), cells, pressure, {1, ranks, 1}), one);
      if (cells[2] > 1) {
        EXPECT_EQ(run_hash(run_communicator(), cells, pressure, {1, 1, ranks}), one);
      }
    }
}

// Hash of a box of walls around a rod of fluid in an anchored solid, with rows so few that ghosts reach beyond a
// neighbour's wall; the layers around B end there.
std::uint64_t thin_hash(MPI_Comm comm, const Int3 &processors) {
  Scene scene;
  GridSpec grid;
  grid.cells = {12, 9, 6};
  grid.length = {3.6, 2.7, 1.8};
  grid.boundary = {Boundary::wall, Boundary::wall, Boundary::wall};
  grid.processors = processors;
  SolverSpec spec;
  static_cast<Method &>(spec) = method_preset(MethodKind::fast);
  spec.sides[0][1].motion.velocity = {0, 0.08, 0.15};
  spec.fluid.body_force.force = {0.05, 0.05, 0.05};
  spec.fluid.inertia = false;
  EXPECT_EQ(scene.create(comm, grid, spec), 0);
  scene.add_phase(
      0.1,
      [](double x, double, double z) {
        return std::clamp(0.5 + (std::hypot(x - 2.83, z - 1.23) - 0.57) / 0.3, 0., 1.);
      },
      true);
  return hash_at(scene, 1.5, 20);
}

TEST(FastStep, SameBitsWhereGhostsReachBeyondANeighboursWall) {
  int ranks = 1;
  MPI_Comm_size(run_communicator(), &ranks);
  const std::uint64_t one = on_one_rank([](MPI_Comm comm) { return thin_hash(comm, {0, 0, 0}); });
  EXPECT_EQ(thin_hash(run_communicator(), {0, 0, 0}), one);
  if (ranks <= 3) {
    EXPECT_EQ(thin_hash(run_communicator(), {1, ranks, 1}), one);
  }
}

}  // namespace
