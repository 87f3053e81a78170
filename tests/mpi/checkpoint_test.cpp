// Checkpoints on 1-4 ranks: a solver that reads one goes on with the bits of the one that wrote it.
#include "base/rank_zero.hpp"
#include "output/saved_state.hpp"
#include "support/files.hpp"
#include "support/scene.hpp"

namespace eulastic {
namespace {

using namespace test;

struct Case {
  const char *name;
  Int3 cells;
  MethodKind method;
  PressureKind pressure;
  std::array<Boundary, 3> boundary;
};

void PrintTo(const Case &c, std::ostream *out) { *out << c.name; }

// A slab on the low wall, which reaches the wall edges, or the same in the middle of a periodic box.
PetscErrorCode build(MPI_Comm comm, const Case &c, Scene *scene) {
  PetscFunctionBeginUser;
  GridSpec grid;
  grid.cells = c.cells;
  for (int d = 0; d < 3; ++d) grid.length[d] = 0.3 * c.cells[d];
  grid.boundary = c.boundary;
  SolverSpec spec;
  static_cast<Method &>(spec) = method_preset(c.method);
  spec.pressure = c.pressure;
  spec.fluid.viscosity = 0.2;
  spec.fluid.body_force.force = {0.1, 0, 0};
  spec.sides[0][1].motion.velocity = {0, 0.2, 0};
  spec.sides[1][1].motion = {{0.3, 0, 0}, 2, 0.1};
  PetscCall(scene->create(comm, grid, spec));
  const Real3 &L = grid.length;
  for (int d = 0; d < 2; ++d)
    set(scene->domain, scene->solver.state().velocity[d], at_face[d],
        [&](double x, double y, double) { return 0.1 * std::sin(6.283185307179586 * (d == 0 ? y / L[1] : x / L[0])); });
  Phase &phase = scene->add_phase(0.7, [&](double x, double y, double) {
    return std::hypot(x - 0.85 * L[0], y - 0.8 * L[1]) < 0.9 ? 1.0 : 0.0;  // over the corner of the high walls
  });
  phase.label = Field(scene->domain, 1);
  for (const Segment &row : scene->domain.rows())
    for (int i = row.i_begin; i < row.i_end; ++i)
      phase.label[0](i, row.j, row.k) = phase.fraction[0](i, row.j, row.k) > 0 ? 1 : 0;
  scene->solver.bodies().add_phase(scene->domain, {BodyPlace{}});
  PetscCall(scene->solver.prepare());
  PetscFunctionReturn(0);
}

PetscErrorCode advance(Scene *scene, int steps, std::uint64_t *hash) {
  PetscFunctionBeginUser;
  FlowExtremes extremes;
  for (int n = 0; n < steps; ++n) {
    if (scene->solver.state().step % 10 == 0) PetscCall(scene->solver.measure(&extremes));
    PetscCall(scene->solver.step(0.01 + 0.001 * (scene->solver.state().step % 3)));
  }
  PetscCall(state_hash(&scene->solver, hash));
  PetscFunctionReturn(0);
}

class Checkpoint : public ::testing::TestWithParam<Case> {};

TEST_P(Checkpoint, GoesOnWithTheSameBits) {
  const SharedDirectory directory;
  const std::string path = directory / checkpoint_name(7);
  Scene writer, alone;
  RunPosition position;
  position.dt = 0.125;
  position.outputs = {3, 2, 1, 0.5, 0.25, 0.75, {}, 0, {}};
  std::uint64_t expected = 0, hash = 0;
  ASSERT_EQ(build(run_communicator(), GetParam(), &writer), 0);
  ASSERT_EQ(advance(&writer, 7, &hash), 0);
  std::vector<double> volumes(writer.solver.domain().rank() == writer.solver.domain().ranks() - 1 ? 1 : 0, 1.5);
  ASSERT_EQ(writer.solver.bodies().follow(writer.domain, writer.solver.state().phases), 0);  // it goes to its owner,
  writer.solver.bodies().set_first_volumes(volumes);                                         // the last rank
  ASSERT_EQ(save_state(&writer.solver, position, "-option value\n", path), 0);
  ASSERT_EQ(advance(&writer, 9, &expected), 0);  // writing has changed nothing

  // On all ranks, then on one: both must end where the writer does.
  Scene reader;
  for (Scene *scene : {&reader, &alone}) {
    const MPI_Comm comm = scene == &reader ? run_communicator() : PETSC_COMM_SELF;
    CheckpointFile file;
    std::string options;
    RunPosition found;
    ASSERT_EQ(build(comm, GetParam(), scene), 0);
    ASSERT_EQ(advance(scene, 3, &hash), 0);  // whatever was there before is gone
    ASSERT_EQ(file.open(comm, path), 0);
    ASSERT_EQ(file.read_options(&options), 0);
    EXPECT_EQ(options, "-option value\n");
    ASSERT_EQ(load_state(&file, path, &scene->solver, &found), 0);
    EXPECT_EQ(scene->solver.state().step, 7);
    EXPECT_EQ(found.dt, 0.125);
    EXPECT_EQ(found.outputs.series_rows, 3);
    EXPECT_EQ(found.outputs.bodies_rows, 2);
    EXPECT_EQ(found.outputs.snapshots, 1);
    EXPECT_EQ(found.outputs.profile_time, 0.75);
    const std::vector<double> owned = comm == PETSC_COMM_SELF ? std::vector<double>{1.5} : volumes;
    EXPECT_EQ(scene->solver.bodies().first_volumes(), owned);
    ASSERT_EQ(advance(scene, 9, &hash), 0);
    EXPECT_EQ(hash, expected);
    ASSERT_EQ(scene->solver.bodies().follow(scene->domain, scene->solver.state().phases), 0);
    EXPECT_EQ(scene->solver.bodies().first_volumes(), owned);
    EXPECT_EQ(scene->solver.sweeps(), writer.solver.sweeps());
    EXPECT_EQ(scene->solver.stages(), writer.solver.stages());
  }
}

constexpr Boundary periodic = Boundary::periodic, wall = Boundary::wall;
INSTANTIATE_TEST_SUITE_P(
    Scenes, Checkpoint,
    ::testing::Values(
        Case{"flat_fast_acm", {16, 17, 1}, MethodKind::fast, PressureKind::acm, {wall, wall, periodic}},
        Case{"flat_classic_smac", {16, 17, 1}, MethodKind::classic, PressureKind::smac, {wall, wall, periodic}},
        Case{"solid_fast_smac", {12, 13, 12}, MethodKind::fast, PressureKind::smac, {periodic, wall, wall}},
        Case{"solid_classic_acm", {12, 13, 12}, MethodKind::classic, PressureKind::acm, {wall, wall, wall}},
        Case{"periodic_fast_acm", {12, 13, 12}, MethodKind::fast, PressureKind::acm, {periodic, periodic, periodic}}),
    [](const auto &test) { return test.param.name; });

TEST(CheckpointFile, RefusesAnotherScene) {
  const SharedDirectory directory;
  const Case flat{"", {16, 17, 1}, MethodKind::fast, PressureKind::acm, {wall, wall, periodic}};
  Case larger = flat;
  larger.cells[0] = 20;
  Scene writer, reader;
  RunPosition position;
  const std::string path = directory / "checkpoint_00000000.h5";
  ASSERT_EQ(build(run_communicator(), flat, &writer), 0);
  ASSERT_EQ(save_state(&writer.solver, position, "-x\n", path), 0);
  ASSERT_EQ(build(run_communicator(), larger, &reader), 0);
  CheckpointFile file;
  ASSERT_EQ(file.open(run_communicator(), path), 0);
  EXPECT_NE(error_of([&] { return load_state(&file, path, &reader.solver, &position); }).find("the grid needs"),
            std::string::npos);
  reader.solver.bodies().add_phase(reader.domain, {BodyPlace{}});
  EXPECT_NE(error_of([&] { return load_state(&file, path, &reader.solver, &position); }).find("another case"),
            std::string::npos);
}

TEST(CheckpointFile, NamesAndLists) {
  const SharedDirectory directory;
  EXPECT_EQ(checkpoint_name(42), "checkpoint_00000042.h5");
  EXPECT_EQ(checkpoint_step("somewhere/checkpoint_00000042.h5"), 42);
  for (const char *other : {"checkpoint_00000042.h5.tmp", "checkpoint_.h5", "snapshot_000042.h5", "x"})
    EXPECT_EQ(checkpoint_step(other), -1) << other;
  if (world_rank() == 0)
    for (const char *name : {"checkpoint_00000009.h5", "checkpoint_00000010.h5", "checkpoint_123456789.h5", "x.h5",
                             "checkpoint_00000011.h5.tmp"})
      std::ofstream(directory / name) << "";
  MPI_Barrier(run_communicator());
  std::vector<long> steps;
  for (const std::string &path : list_checkpoints(directory / "")) steps.push_back(checkpoint_step(path));
  EXPECT_EQ(steps, (std::vector<long>{123456789, 10, 9}));
}

}  // namespace
}  // namespace eulastic
