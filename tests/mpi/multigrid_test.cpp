// The V-cycle: the same bits however cells are shared among ranks and threads, and however many stages share a pass.
#include "pressure/multigrid.hpp"
#include "base/rank_zero.hpp"
#include "grid/blocks.hpp"
#include "support/poisson_scene.hpp"

#include <cstring>

using namespace eulastic;
using namespace eulastic::test;

namespace {

// V D on the grid of `spec`.
struct Cycle : PoissonScene {
  Field solution, scratch;

  Cycle(MPI_Comm comm, const GridSpec &spec) : PoissonScene(comm, spec), solution(domain, 1), scratch(domain, 1) {
    Multigrid multigrid;
    EXPECT_EQ(multigrid.create(domain), 0);
    set(noise);
    EXPECT_EQ(exchange->update_ghosts(divergence, Multigrid::halo), 0);
    EXPECT_EQ(multigrid.apply(divergence, solution, scratch), 0);
  }
  int stages_of_a_pass() const { return StagePass::depth(domain, domain.split(), 1, 3); }
};

// Cells, and ghosts within the domain, that differ in any bit from those of `one` rank.
int differences(const Cycle &s, const Cycle &one) {
  int count = 0;
  const Layout &own = s.domain.layout();
  Int3 low{}, high{};
  for (int d = 0; d < 3; ++d) {
    const bool ghosts = d < s.domain.dimension();
    low[d] = ghosts && !s.domain.touches_low(d) ? -1 : 0;
    high[d] = own.cells[d] + (ghosts && !s.domain.touches_high(d));
  }
  for (int k = low[2]; k < high[2]; ++k)
    for (int j = low[1]; j < high[1]; ++j)
      for (int i = low[0]; i < high[0]; ++i) {
        const Int3 local{i, j, k}, &cells = s.domain.domain_cells();
        Int3 image{};
        for (int d = 0; d < 3; ++d) image[d] = (own.begin[d] + local[d] + cells[d]) % cells[d];
        const double a = s.solution[0](i, j, k), b = one.solution[0](image[0], image[1], image[2]);
        count += std::memcmp(&a, &b, sizeof a) != 0;
      }
  return count;
}

}  // namespace

// Two ghost layers allow two stages to a pass, five three, in 66 cells also where four ranks share them. More than
// 32768 cells have two coarser levels that ranks share. Threads of more than two ranks would wait for each other.
TEST(MultigridCycle, SameBitsOnAnyRanksThreadsAndStages) {
  int ranks = 0, deepest = 1;
  MPI_Comm_size(run_communicator(), &ranks);
  for (const Int3 &cells : {Int3{40, 32, 28}, Int3{29, 65, 27}, Int3{26, 25, 66}})
    for (GridSpec spec : all_boundaries(cells)) {
      if (cells[0] != 29 && spec.boundary[0] == spec.boundary[1]) continue;  // all boundaries at odd sizes
      spec.ghosts = 2;
      const Cycle one(PETSC_COMM_SELF, spec);
      for (GridSpec &shared : all_decompositions(spec, false))
        for (shared.ghosts = 2; shared.ghosts <= 5; shared.ghosts += 3)
          for (int team = 1; team <= (ranks > 2 ? 1 : 3); team += 2) {
            set_threads(team);
            const Cycle many(run_communicator(), shared);
            set_threads(1);
            EXPECT_EQ(differences(many, one), 0) << name(shared) << shared.ghosts << " ghosts, " << team << " threads";
            deepest = std::max(deepest, many.stages_of_a_pass());
          }
    }
  EXPECT_EQ(deepest, 3);
}

// Three cells to a rank are too few for half of them, and the level too large for every rank.
TEST(MultigridCycle, SameBitsWhereRanksAreJoined) {
  int ranks = 0;
  MPI_Comm_size(run_communicator(), &ranks);
  for (int d = 0; d < 3; ++d)
    for (const bool flat : {false, true}) {
      if (flat && d == 2) continue;
      Int3 cells = flat ? Int3{2048, 2048, 1} : Int3{64, 64, 64}, processors{1, 1, 1};
      cells[d] = 3 * ranks;
      processors[d] = ranks;
      for (GridSpec &spec : all_boundaries(cells)) {
        for (int c = 0; c < 3; ++c) spec.length[c] = cells[c];
        const Cycle one(PETSC_COMM_SELF, spec);
        spec.processors = processors;
        const Cycle many(run_communicator(), spec);
        EXPECT_EQ(differences(many, one), 0) << name(spec) << "split along "
                                             << "xyz"[d];
        bool joined = false;
        const auto levels = Multigrid::plan(many.domain);
        for (std::size_t l = 1; l < levels.size(); ++l)
          joined |= levels[l]->box().domain_cells() == levels[l - 1]->box().domain_cells() &&
                    levels[l]->partition().ranks() > 1;
        EXPECT_EQ(joined, ranks > 1);
      }
    }
}
