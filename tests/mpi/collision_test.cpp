// Two beads that a shear flow drives together: separate, whole, the same bits on any ranks and after a restart.
#include "base/rank_zero.hpp"
#include "diagnostics/energy_rates.hpp"
#include "output/saved_state.hpp"
#include "scene/scene.hpp"
#include "solver/synchronised_state.hpp"
#include "support/all_bodies.hpp"
#include "support/command_line.hpp"
#include "support/files.hpp"

#include <cmath>
#include <fstream>

using namespace eulastic;
using namespace eulastic::test;

namespace {

// What some steps have made.
struct Outcome {
  std::uint64_t hash = 0;
  std::vector<double> change;  // of the volume, per body
};

const std::string flat_beads =
    "-time_end 9 -grid_cells 40,36,1 -grid_length 5,4.5,1 -boundary_y wall -boundary_ymax_velocity 1,0,0 "
    "-boundary_ymin_velocity "
    "-1,0,0 -initial_velocity couette -fluid_viscosity .5 -pressure_solver smac -species bead -bead_shape sphere "
    "-bead_radius .6 -bead_shear_modulus 1 -bead_placement list -bead_positions beads.csv ";
const std::string solid_beads =
    "-time_end 9 -grid_cells 28,18,16 -grid_length 3.5,2.25,2 -boundary_y wall -boundary_ymax_velocity 1,0,0 "
    "-boundary_ymin_velocity -1,0,0 -initial_velocity couette -fluid_viscosity .5 -pressure_solver smac -species bead "
    "-bead_shape sphere -bead_radius .35 -bead_shear_modulus 1 -bead_placement list -bead_positions beads.csv ";

PetscErrorCode advance(Solver *solver, int steps, double dt) {
  PetscFunctionBeginUser;
  FlowExtremes extremes;
  for (int n = 0; n < steps; ++n) {
    if (solver->state().step % 10 == 0) PetscCall(solver->measure(&extremes));
    PetscCall(solver->step(dt));
  }
  PetscFunctionReturn(0);
}

std::vector<double> volumes(Solver &solver) {
  std::vector<BodyMeasure> owned, bodies;
  std::vector<double> all;
  const std::vector<Phase> *phases = nullptr;
  std::vector<BodyInBox> boxed;
  EXPECT_EQ(solver.synchronised().phases(&phases), 0);
  EXPECT_EQ(solver.synchronised().bodies(&boxed), 0);
  EXPECT_EQ(solver.bodies().measure(solver.domain(), *phases, solver.state().velocity, strain_energy, &owned, boxed),
            0);
  const int count = solver.bodies().bodies();
  EXPECT_EQ(all_bodies(solver.domain().comm(), count, count, owned, &bodies), 0);
  for (const BodyMeasure &body : bodies) all.push_back(body.volume);
  return all;
}

Outcome collide(MPI_Comm comm, const std::string &options, int steps, double dt, const std::string &checkpoint = {},
                int stop = 0) {
  Outcome outcome;
  const ParseResult parsed = parse_line(options);
  EXPECT_EQ(parsed.error, "");
  Domain domain;
  Solver solver;
  std::string reason;
  EXPECT_EQ(domain.create(comm, parsed.config.grid), 0);
  EXPECT_EQ(build_scene(comm == PETSC_COMM_SELF ? test::with_all_places(parsed.config) : parsed.config, domain, &solver,
                        &reason),
            0);
  EXPECT_EQ(reason, "");
  const std::vector<double> before = volumes(solver);
  RunPosition position;
  if (!checkpoint.empty() && stop == 0) {
    CheckpointFile file;
    EXPECT_EQ(file.open(comm, checkpoint), 0);
    EXPECT_EQ(load_state(&file, checkpoint, &solver, &position), 0);
    steps -= static_cast<int>(solver.state().step);
  }
  EXPECT_EQ(advance(&solver, stop > 0 ? stop : steps, dt), 0);
  if (stop > 0) {
    EXPECT_EQ(save_state(&solver, position, "-x\n", checkpoint), 0);
  }
  EXPECT_EQ(state_hash(&solver, &outcome.hash), 0);
  const std::vector<double> after = volumes(solver);
  for (std::size_t b = 0; b < after.size(); ++b) outcome.change.push_back(after[b] / before[b] - 1);
  return outcome;
}

// The two beads of a line of positions.
std::string with_beads(const SharedDirectory &directory, std::string options, const std::string &places) {
  const std::string path = directory / "beads.csv";
  if (world_rank() == 0) std::ofstream(path) << "x,y,z\n" << places;
  MPI_Barrier(run_communicator());
  return options.replace(options.find("beads.csv"), 9, path);
}

}  // namespace

TEST(Collision, CollisionsHaveTheSameBitsOnAnyRanksAndAfterARestart) {
  for (const bool flat : {true, false}) {
    const SharedDirectory directory;
    // Across the seam of x: one comes from the left, one from the right.
    const std::string options = flat ? with_beads(directory, flat_beads, "4.3,2.7,.5\n1.3,1.8,.5\n")
                                     : with_beads(directory, solid_beads, "2.8,1.4,.9\n1,.85,1.05\n");
    const int steps = flat ? 90 : 50;
    const double dt = flat ? .012 : .016;
    const Outcome one = collide(PETSC_COMM_SELF, options, steps, dt);
    EXPECT_EQ(collide(run_communicator(), options, steps, dt).hash, one.hash);
    for (const int stop : {3, steps - 2}) {
      const std::string path = directory / checkpoint_name(stop);
      collide(run_communicator(), options, steps, dt, path, stop);
      EXPECT_EQ(collide(run_communicator(), options, steps, dt, path).hash, one.hash) << stop;
    }
  }
}

TEST(Collision, PressedBodiesKeepTheirVolumes) {
  const SharedDirectory directory;
  const std::string options = with_beads(directory, flat_beads, "1.2,2.6,.5\n3.1,2.1,.5\n2.35,3.1,.5\n");
  const Outcome separate = collide(run_communicator(), options, 110, .012);
  const Outcome merged = collide(run_communicator(), options + "-bead_contact merge", 110, .012);
  for (int b = 0; b < 3; ++b) {
    EXPECT_LT(std::fabs(separate.change[b]), 1e-9);
    EXPECT_GT(std::fabs(merged.change[b]), 0.01);
  }
}

TEST(Collision, BodiesThatOverlapAtTheStartAreBothWhole) {
  const SharedDirectory directory;
  const std::string options = with_beads(directory, flat_beads, "2,2.2,.5\n3.1,2.3,.5\n");
  for (const bool merge : {false, true}) {
    const ParseResult parsed = parse_line(options + (merge ? "-bead_contact merge" : ""));
    ASSERT_EQ(parsed.error, "");
    Domain domain;
    Solver solver;
    std::string reason;
    ASSERT_EQ(domain.create(run_communicator(), parsed.config.grid), 0);
    ASSERT_EQ(build_scene(parsed.config, domain, &solver, &reason), 0);
    for (const double volume : volumes(solver)) {
      if (merge) {
        EXPECT_LT(volume, 0.9999 * 3.14159265358979 * 0.36);
      } else {
        EXPECT_NEAR(volume, 3.14159265358979 * 0.36, 3e-6);
      }
    }
  }
}
