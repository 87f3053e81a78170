// Bodies in boxes are shared out so that ranks have about as much work, and -check_only tells it in advance.
#include "scene/rank_work.hpp"
#include "base/rank_zero.hpp"
#include "boxes/share_out.hpp"
#include "scene/scene.hpp"
#include "solver/synchronised_state.hpp"
#include "support/command_line.hpp"
#include "support/lopsided.hpp"

#include <algorithm>
#include <numeric>

using namespace eulastic;

namespace {

const std::string beads =
    "-time_end 1 -grid_cells 32,24,40 -grid_length 4,3,5 -boundary_y wall -species ground,bead -ground_shape slab "
    "-ground_axis "
    "y -ground_interval 0,.6 -ground_shear_modulus 1 -bead_shape ellipsoid -bead_semi_axes .3,.25,.2 "
    "-bead_shear_modulus 1 "
    "-bead_placement random -bead_orientation random -bead_count 24 -bead_gap .1";

struct RankWork {
  double sum = 0, largest = 0;  // of all; of a body
};

RankWork work_of(Solver &solver) {
  RankWork work;
  std::vector<BodyInBox> bodies;
  work.sum = flow_work * solver.domain().cell_count();
  for (const Phase &phase : solver.state().phases)
    if (!phase.boxed) work.sum += phase_work(phase.material, false) * double(phase.rows.cells());
  EXPECT_EQ(solver.synchronised().bodies(&bodies), 0);
  for (const BodyInBox &body : bodies) {
    const double own = phase_work(body.phase->material, true) * body.box->cell_count();
    work.sum += own;
    work.largest = std::max(work.largest, own);
  }
  return work;
}

}  // namespace

TEST(RankWork, IsEvenAndToldInAdvance) {
  const MPI_Comm comm = run_communicator();
  int ranks, rank;
  MPI_Comm_size(comm, &ranks);
  MPI_Comm_rank(comm, &rank);
  ParseResult parsed = parse_line(beads);
  ASSERT_EQ(parsed.error, "");
  parsed.config.grid.processors = {1, 1, ranks};
  for (const GridSpec &grid : {parsed.config.grid, lopsided(parsed.config.grid)}) {
    Config config = parsed.config;
    config.grid = grid;
    Domain domain;
    Solver solver;
    std::string reason, line;
    ASSERT_EQ(domain.create(comm, grid), 0);
    ASSERT_EQ(build_scene(config, domain, &solver, &reason), 0);
    ASSERT_EQ(reason, "");
    RankWork own = work_of(solver);
    std::vector<double> all(ranks);
    MPI_Allgather(&own.sum, 1, MPI_DOUBLE, all.data(), 1, MPI_DOUBLE, comm);
    MPI_Allreduce(MPI_IN_PLACE, &own.largest, 1, MPI_DOUBLE, MPI_MAX, comm);
    const double mean = std::accumulate(all.begin(), all.end(), 0.) / ranks, body = own.largest / mean;
    const double fullest = *std::max_element(all.begin(), all.end()) / mean;
    EXPECT_LT(body, 0.4);
    // At most the halves of a body at both ends of what a rank takes.
    EXPECT_LE(fullest, 1 + body);
    ASSERT_EQ(describe_work(comm, config, ranks, &line), 0);
    if (ranks == 1 || rank > 0) {
      EXPECT_EQ(line, "");
      continue;
    }
    double told = 0;
    ASSERT_EQ(std::sscanf(line.c_str(), "work of the fullest rank / mean (estimate): %lf", &told), 1) << line;
    EXPECT_NEAR(told, fullest, 0.05) << line;
  }
}
