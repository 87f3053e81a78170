// A vessel with red cells and platelets at random: the same scene, and the same first steps, on any ranks.
#include "base/rank_zero.hpp"
#include "bodies/near_places.hpp"
#include "diagnostics/state_hash.hpp"
#include "output/saved_state.hpp"
#include "scene/scene.hpp"
#include "support/all_bodies.hpp"
#include "support/command_line.hpp"
#include "support/files.hpp"

#include <algorithm>

using namespace eulastic;

namespace {

// Of what moves on this rank, without labels and what is known of bodies.
std::uint64_t flow_hash(const Domain &domain, const State &state) {
  std::uint64_t sum = 0, salt = 0;
  for (int d = 0; d < state.velocity.count(); ++d) sum += hash_points(domain, state.velocity[d], at_face[d], ++salt);
  sum += hash_points(domain, state.pressure[0], at_centre, ++salt);
  for (const Phase &phase : state.phases) {
    sum += hash_points(domain, phase.fraction[0], at_centre, ++salt);
    for (int c = 0; c < phase.tensor.field.count(); ++c)
      sum += hash_points(domain, phase.tensor.field[c], phase.tensor.components()[c].at, ++salt);
  }
  return sum;
}

PetscErrorCode first_steps(MPI_Comm comm, const Config &config, std::uint64_t hash[2], std::uint64_t *flow = nullptr) {
  PetscFunctionBeginUser;
  Domain domain;
  Solver solver;
  std::string reason;
  PetscCall(domain.create(comm, config.grid));
  PetscCall(build_scene(config, domain, &solver, &reason));
  EXPECT_EQ(reason, "");
  PetscCall(state_hash(&solver, &hash[0]));
  FlowExtremes extremes;
  for (int n = 0; n < 2; ++n) {
    PetscCall(solver.measure(&extremes));
    PetscCall(solver.step(1));
  }
  PetscCall(state_hash(&solver, &hash[1]));
  EXPECT_EQ(solver.bodies().bodies() > 0, config.body_series);
  const Phase &cells = solver.state().phases[1];
  EXPECT_EQ(bool(cells.label), config.body_series && !cells.boxed);
  if (flow) *flow = flow_hash(domain, solver.state());
  PetscFunctionReturn(0);
}

const std::string capillary =
    "-time_end 1 -grid_cells 40,24,24 -grid_length 42,25,25 -boundary_y wall -boundary_z wall -body_force 1e-3,0,0 "
    "-species vessel,rbc,plt -vessel_shape tube -vessel_axis x -vessel_diameter 24 -vessel_shear_modulus .05 "
    "-rbc_shape biconcave -rbc_diameter 8 -rbc_shear_modulus .02 -rbc_placement random -rbc_orientation random "
    "-rbc_hematocrit 0.15 -plt_shape ellipsoid -plt_semi_axes 2,2,1.6 -plt_shear_modulus .02 -plt_placement random "
    "-plt_orientation random -plt_count 6 ";

}  // namespace

TEST(Seeding, SameSceneOnAnyRanks) {
  const ParseResult result = parse_line(capillary);
  ASSERT_EQ(result.error, "");
  std::uint64_t alone[2] = {}, together[2] = {};
  ASSERT_EQ(first_steps(PETSC_COMM_SELF, test::with_all_places(result.config), alone), 0);
  ASSERT_EQ(first_steps(run_communicator(), result.config, together), 0);
  EXPECT_EQ(alone[0], together[0]);
  EXPECT_EQ(alone[1], together[1]);
  EXPECT_NE(alone[0], alone[1]);
}

TEST(BodySeries, OffTheFlowIsTheSame) {
  std::uint64_t hash[2][2] = {}, flow[2] = {};
  for (const bool on : {true, false}) {
    const ParseResult result =
        parse_line(capillary + "-rbc_contact merge -plt_contact merge -body_series " + (on ? "true" : "false"));
    ASSERT_EQ(result.error, "");
    ASSERT_EQ(first_steps(run_communicator(), result.config, hash[on], &flow[on]), 0);
  }
  EXPECT_EQ(flow[0], flow[1]);
  EXPECT_NE(hash[0][1], hash[1][1]) << "labels are part of the state, or are not there";
}

TEST(Seeding, ARankBuildsOnlyWhatReachesItsCells) {
  // 27000 bodies of radius 0.4 cells; those with a centre up to a cell and that much outside count.
  const ParseResult result = parse_line(
      "-time_end 1 -grid_cells 80,80,80 -grid_length 200,200,200 -species ball -ball_shape sphere -ball_radius 1 "
      "-ball_shear_modulus 1 -ball_placement lattice -ball_count 30,30,30 -ball_jitter 1");
  ASSERT_EQ(result.error, "");
  Domain domain;
  ASSERT_EQ(domain.create(run_communicator(), result.config.grid), 0);
  const Places all = test::with_all_places(result.config).places[0], &mine = result.config.places[0];
  EXPECT_EQ(int(mine.known.size()), BodyRange::of(27000, test::world_rank(), domain.ranks()).size());
  Places near;
  ASSERT_EQ(send_to_near_ranks(domain.comm(), domain, result.config.species[0], mine, &near), 0);
  double most = 1;
  for (int d = 0; d < 3; ++d) most *= std::min(1.0, (domain.cells()[d] + 2 * (0.4 + 1) + 2) / 80.0);
  EXPECT_LE(double(near.known.size()), most * 27000);
  // Nobody is left out: every body with its centre in a cell of this rank is there.
  unsigned long sums[2] = {0, near.known.size()};
  for (const NumberedPlace &place : all.known) {
    bool here = true;
    for (int d = 0; d < 3; ++d) {
      const int cell = static_cast<int>(place.centre[d] / 2.5) - domain.layout().begin[d];
      here = here && cell >= 0 && cell < domain.cells()[d];
    }
    sums[0] += here;
    const auto found = std::lower_bound(near.known.begin(), near.known.end(), place.index,
                                        [](const NumberedPlace &one, int index) { return one.index < index; });
    const bool is_there = found != near.known.end() && found->index == place.index;
    EXPECT_TRUE(!here || is_there);
    if (is_there) {
      EXPECT_EQ(found->centre, place.centre);
    }
  }
  MPI_Allreduce(MPI_IN_PLACE, sums, 2, MPI_UNSIGNED_LONG, MPI_SUM, run_communicator());
  EXPECT_EQ(sums[0], 27000u);
  EXPECT_GE(sums[1], 27000u);
}
