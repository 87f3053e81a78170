// ACM sweeps: any residual is reached on any boundaries, the same bits on any decomposition, what memory buys.
#include "base/rank_zero.hpp"
#include "diagnostics/state_hash.hpp"
#include "grid/threads.hpp"
#include "pressure/acm_iterations.hpp"
#include "pressure/smac.hpp"
#include "support/poisson_scene.hpp"

#include <cstring>

using namespace eulastic;
using namespace eulastic::test;

namespace {

struct Sweeper : PoissonScene {
  WorkSpace work{domain};
  AcmIterativeSolver solver;
  Sweeper(MPI_Comm comm, const GridSpec &spec, const AcmIterativeOptions &options) : PoissonScene(comm, spec) {
    EXPECT_EQ(solver.create(domain, *exchange, options, work), 0);
  }
  // Solves to `relative` times the rms of the divergence.
  void solve(double relative) {
    solver.set_target(relative * rms_divergence());
    EXPECT_EQ(solver.solve(dt, divergence, pressure, increment), 0);
  }
};

// Cells and ghosts of `s` that differ in any bit from the periodic or mirror image in the solution `one` of one rank.
int differences(const PoissonScene &s, const PoissonScene &one) {
  int count = 0;
  const Layout &own = s.domain.layout();
  const int gz = std::min(1, own.ghosts[2]);
  for (int k = -gz; k < own.cells[2] + gz; ++k)
    for (int j = -1; j < own.cells[1] + 1; ++j)
      for (int i = -1; i < own.cells[0] + 1; ++i) {
        const Int3 local{i, j, k};
        Int3 image{};
        for (int d = 0; d < 3; ++d) {
          const int n = s.domain.domain_cells()[d], g = own.begin[d] + local[d];
          image[d] = !s.domain.is_wall(d) ? (g + n) % n : g < 0 ? -1 - g : g >= n ? 2 * n - 1 - g : g;
        }
        const double a = s.increment[0](i, j, k), b = one.increment[0](image[0], image[1], image[2]);
        count += std::memcmp(&a, &b, sizeof a) != 0;
      }
  return count;
}

double smooth_and_rough(const Int3 &cells, double phase, int i, int j, int k) {
  const double x = 2 * M_PI * (i + 0.5) / cells[0], y = M_PI * (j + 0.5) / cells[1], z = M_PI * (k + 0.5) / cells[2];
  return std::sin(x + phase) * std::cos(y) + std::cos(2 * y + phase) * std::cos(z) + 0.2 * noise(i, j, k);
}

}  // namespace

// The residual of the increment itself, not the solver's own account of it, at most 20 % off the target for the
// rounding of D - sum c lap q (1e-16 N^2). The factor per sweep is below 0.4 even for odd cells and unequal spacings.
TEST(AcmSweeps, ReachesAnyTargetOnAllBoundariesAndDecompositions) {
  for (const Int3 &cells : {Int3{13, 10, 11}, Int3{16, 24, 12}, Int3{13, 10, 1}, Int3{16, 24, 1}, Int3{33, 7, 5}})
    for (const GridSpec &spec : all_boundaries(cells))
      for (const double target : {1e-2, 1e-6, 1e-12}) {
        Sweeper one(PETSC_COMM_SELF, spec, {40, 2, true});
        one.set(noise);
        one.solve(target);
        const std::vector<GridSpec> decompositions = all_decompositions(spec);
        for (const GridSpec &shared : decompositions) {
          Sweeper many(run_communicator(), shared, {40, 2, true});
          many.set(noise);
          many.solve(target);
          EXPECT_LE(many.rms_residual(), 1.2 * target * many.rms_divergence()) << name(shared);
          EXPECT_LE(many.solver.sweeps(), 2 + std::log(target) / std::log(0.4)) << name(shared);
          EXPECT_EQ(many.solver.sweeps(), one.solver.sweeps()) << name(shared);
          EXPECT_EQ(differences(many, one), 0) << name(shared);
        }
      }
}

// Levels that stay shared for a while, begin at odd cells on some rank, and end in a cell of one or three.
TEST(AcmSweeps, SameBitsOnLargerGrids) {
  for (const Int3 &cells : {Int3{520, 34, 1}, Int3{70, 101, 1}, Int3{40, 38, 35}, Int3{64, 32, 48}, Int3{25, 51, 30}})
    for (const Boundary b : {Boundary::periodic, Boundary::wall}) {
      GridSpec spec = all_boundaries(cells)[0];
      spec.boundary = {b, Boundary::wall, Boundary::periodic};
      const auto f = [&](int i, int j, int k) { return smooth_and_rough(cells, 0.3, i, j, k); };
      for (const bool multigrid : {true, false}) {
        Sweeper one(PETSC_COMM_SELF, spec, {6, 2, multigrid});
        one.set(f);
        for (int repeat = 0; repeat < 2; ++repeat) one.solve(1e-5);
        int team = multigrid ? 1 : 3;  // threads: with every other decomposition
        for (const GridSpec &shared : all_decompositions(spec)) {
          team = 4 - team;
          set_threads(team);
          Sweeper many(run_communicator(), shared, {6, 2, multigrid});
          many.set(f);
          for (int repeat = 0; repeat < 2; ++repeat) many.solve(1e-5);
          set_threads(1);
          EXPECT_EQ(differences(many, one), 0) << name(shared) << multigrid << ", " << team << " threads";
        }
      }
    }
}

// However many sweeps there are, all of their directions are in the increment: what it leaves is what the solver says.
TEST(AcmSweeps, LeavesWhatItSays) {
  for (const Int3 &cells : {Int3{32, 24, 16}, Int3{40, 26, 1}})
    for (const GridSpec &spec : all_boundaries(cells))
      for (const bool multigrid : {true, false})
        for (const int memory : {0, 1, 3})
          for (int sweeps = 1; sweeps <= 5; ++sweeps) {
            Sweeper s(run_communicator(), spec, {sweeps, memory, multigrid});
            for (int step = 0; step < 3; ++step) {
              s.set([&](int i, int j, int k) { return smooth_and_rough(cells, 0.3 * step, i, j, k); });
              s.solve(1e-14);
            }
            EXPECT_NEAR(s.solver.residual_rms() / s.rms_residual(), 1, 1e-6)
                << name(spec) << multigrid << memory << ", " << sweeps << " sweeps";
          }
}

// What is remembered hardly sees a right-hand side that is all but orthogonal to it: what the projection then changes
// is mostly rounding, of which the next sweeps must make nothing.
TEST(AcmSweeps, MemoryOfLittleUse) {
  const Int3 cells{32, 24, 16};
  for (const bool multigrid : {true, false})
    for (const double share : {1e-6, 1e-8, 1e-10, 1e-12, 1e-13, 1e-14, 1e-15}) {
      const GridSpec spec = all_boundaries(cells)[0];
      Sweeper s(run_communicator(), spec, {100, 1, multigrid});
      const auto old = [&](int i, int, int) { return std::sin(2 * M_PI * (i + 0.5) / cells[0]); };
      s.set(old);
      s.solve(1e-12);
      s.set([&](int i, int j, int k) {
        const double x = 2 * M_PI * (i + 0.5) / cells[0];
        return share * old(i, j, k) + std::sin(2 * x + 0.3) + std::cos(5 * x + j) * (1 + 0.1 * noise(7, j, k));
      });
      s.solve(1e-9);
      EXPECT_NEAR(s.solver.residual_rms(), s.rms_residual(), 1e-10 * s.rms_divergence()) << share << multigrid;
    }
}

// |q - q_exact| <= |residual| / smallest eigenvalue, (pi / longest side)^2 between walls; both have zero mean.
TEST(AcmSweeps, AgreesWithTheExactSolver) {
  if (!SmacSolver::available()) GTEST_SKIP() << "built without FFTW";
  for (const Int3 &cells : {Int3{13, 10, 11}, Int3{32, 24, 16}, Int3{40, 26, 1}})
    for (const GridSpec &spec : all_boundaries(cells)) {
      Sweeper sweeps(run_communicator(), spec, {});
      PoissonScene exact(run_communicator(), spec);
      std::unique_ptr<PressureSolver> smac;
      ASSERT_EQ(SmacSolver::create(exact.domain, *exact.exchange, &smac), 0);
      const auto f = [&](int i, int j, int k) { return smooth_and_rough(cells, 0.9, i, j, k); };
      sweeps.set(f);
      exact.set(f);
      sweeps.solve(1e-8);
      ASSERT_EQ(smac->solve(exact.dt, exact.divergence, exact.pressure, exact.increment), 0);
      const double error =
          sweeps.rms([&](int i, int j, int k) { return sweeps.increment[0](i, j, k) - exact.increment[0](i, j, k); });
      EXPECT_LE(error, 1e-8 * sweeps.rms_divergence() / sweeps.dt * std::pow(2.3 / M_PI, 2)) << name(spec);
      EXPECT_LE(std::abs(global_sum(sweeps.domain, sweeps.increment[0])), 1e-12 * sweeps.domain.domain_cell_count());
    }
}

// A right-hand side that turns: with phase steps of 0.05 the last increment alone leaves about 0.05 of it, the last two
// 0.05^2 where rounding and the tolerance of the solutions remembered allow. Nothing but the projection, no sweep.
TEST(AcmSweeps, MemoryForetellsTheNextIncrement) {
  GridSpec spec;
  spec.cells = {32, 32, 16};
  spec.length = {1, 1, 0.5};
  spec.boundary = {Boundary::periodic, Boundary::wall, Boundary::wall};
  double foretold[4] = {};
  long sweeps[4] = {};
  for (const int memory : {0, 1, 2, 3}) {
    Sweeper s(run_communicator(), spec, {20, memory, true});
    for (int step = 0; step < 12; ++step) {
      s.set([&](int i, int j, int k) { return smooth_and_rough(spec.cells, 0.05 * step, i, j, k); });
      s.solve(1e-3);
      EXPECT_LE(s.rms_residual(), 1.001e-3 * s.rms_divergence());
    }
    s.set([&](int i, int j, int k) { return smooth_and_rough(spec.cells, 0.05 * 12, i, j, k); });
    sweeps[memory] = s.solver.sweeps();
    s.solve(1);  // any residual is small enough
    foretold[memory] = s.rms_residual() / s.rms_divergence();
    EXPECT_EQ(s.solver.sweeps() - sweeps[memory], memory > 0 ? 0 : 1);
    PetscPrintf(run_communicator(), "memory %d: leaves %.1e; 12 steps to 1e-3 took %ld sweeps\n", memory,
                foretold[memory], sweeps[memory]);
  }
  EXPECT_LT(foretold[1], 0.06);
  EXPECT_LT(foretold[2], 0.1 * foretold[1]);
  EXPECT_LT(sweeps[1], sweeps[0]);
  EXPECT_LT(sweeps[2], sweeps[1]);
}

// Written to a checkpoint (owned cells) and read back into a new solver, the memory gives the same bits.
TEST(AcmSweeps, MemoryIsAllThatARestartNeeds) {
  for (const GridSpec &spec : all_boundaries({14, 12, 13})) {
    const auto at = [&](int step) {
      return [&spec, step](int i, int j, int k) { return smooth_and_rough(spec.cells, 0.2 * step, i, j, k); };
    };
    Sweeper on(run_communicator(), spec, {3, 3, true}), restarted(run_communicator(), spec, {3, 3, true});
    for (int step = 0; step < 5; ++step) {
      on.set(at(step));
      on.solve(1e-3);
    }
    const Field &from = *on.solver.memory();
    restarted.solver.clear_memory();
    Field &to = *restarted.solver.memory();
    for (int f = 0; f < from.count(); ++f)
      for (const Segment &s : on.domain.rows()) std::copy_n(from[f].row(s.j, s.k), s.size(), to[f].row(s.j, s.k));
    for (Sweeper *s : {&on, &restarted}) {
      s->set(at(5));
      s->solve(1e-3);
    }
    EXPECT_EQ(hash_points(on.domain, on.increment[0], at_centre, 1),
              hash_points(on.domain, restarted.increment[0], at_centre, 1))
        << name(spec);
  }
}

// Minimal residual with the previous direction: the first sweep is the steepest one of ACM, D lap D / (lap D)^2; the
// residual falls with every sweep, is the one the minimisation predicted, and beats one direction at a time.
TEST(AcmSweeps, WithoutMultigridItIsTheConjugateResidualMethod) {
  for (const Int3 &cells : {Int3{24, 20, 12}, Int3{32, 24, 1}})
    for (const GridSpec &spec : all_boundaries(cells)) {
      double before = 1, plain = 1;
      Sweeper one(run_communicator(), spec, {1, 0, false});
      const auto f = [&](int i, int j, int k) { return smooth_and_rough(cells, 0.4, i, j, k); };
      one.set(f);
      for (const int sweeps : {1, 2, 3, 5, 10, 20, 40}) {
        Sweeper s(run_communicator(), spec, {sweeps, 0, false});
        s.set(f);
        s.solve(0);
        const double residual = s.rms_residual(), relative = residual / s.rms_divergence();
        EXPECT_EQ(s.solver.sweeps(), sweeps);
        EXPECT_LT(relative, before) << name(spec);
        EXPECT_NEAR(s.solver.residual_rms() / residual, 1, 1e-9) << name(spec);
        before = relative;
      }
      for (int sweep = 0; sweep < 40; ++sweep) {  // steepest descent, restarted at every step
        one.solve(0);
        plain = one.solver.residual_rms();
        std::vector<double> left;
        for (const Segment &s : one.domain.rows())
          for (int i = 0; i < s.i_end; ++i) left.push_back(one.residual(i, s.j, s.k));
        auto value = left.begin();
        for (const Segment &s : one.domain.rows())
          for (int i = 0; i < s.i_end; ++i) one.divergence[0](i, s.j, s.k) = *value++;
      }
      Sweeper start(run_communicator(), spec, {1, 0, false});
      start.set(f);
      EXPECT_LT(before, 0.5 * plain / start.rms_divergence()) << name(spec);
    }
}

TEST(AcmSweeps, SurvivesNothingToDoAndNotANumber) {
  for (const bool multigrid : {true, false})
    for (const GridSpec &spec : all_boundaries({12, 12, 1})) {
      Sweeper s(run_communicator(), spec, {5, 2, multigrid});
      s.set([](int, int, int) { return 0.0; });
      s.solve(0);
      EXPECT_EQ(s.rms(s.increment[0]), 0.0);
      s.set([](int, int, int) { return 3.0; }, false);  // no divergence that a pressure could remove
      s.solve(0);
      EXPECT_LT(s.rms(s.increment[0]), 1e-10);
      s.set(noise);
      if (s.domain.layout().begin == Int3{0, 0, 0}) s.divergence[0](1, 1, 0) = std::nan("");
      s.solve(0);
      EXPECT_TRUE(std::isnan(s.increment[0](0, 0, 0)));
    }
}
