// The pressure solvers where the pressure is given on some sides: the increment is 0 there and its mean is not free.
#include "base/rank_zero.hpp"
#include "field/open_boundaries.hpp"
#include "pressure/acm_iterations.hpp"
#include "pressure/ksp.hpp"
#include "pressure/smac.hpp"
#include "support/on_one_rank.hpp"
#include "support/open_boundaries.hpp"

#include <cstring>

using namespace eulastic;
using namespace eulastic::test;

namespace {

enum class Kind { sweeps, remembering, descent, smac, ksp };

struct OpenScene : PoissonScene {
  std::unique_ptr<PressureSolver> solver;
  WorkSpace work;

  OpenScene(MPI_Comm comm, const GridSpec &spec, Kind kind) : PoissonScene(comm, spec), work(domain) {
    if (kind == Kind::smac) {
      EXPECT_EQ(SmacSolver::create(domain, *exchange, &solver), 0);
    } else if (kind == Kind::ksp) {
      auto ksp = std::make_unique<KspSolver>();
      EXPECT_EQ(ksp->create(domain, *exchange), 0);
      solver = std::move(ksp);
    } else {
      auto sweeps = std::make_unique<AcmIterativeSolver>();
      const bool coarse = kind != Kind::descent;
      EXPECT_EQ(
          sweeps->create(domain, *exchange, {coarse ? 60 : 4000, kind == Kind::remembering ? 2 : 0, coarse}, work), 0);
      solver = std::move(sweeps);
    }
    set(noise, false);
    fill_ghosts_of_increment(domain, divergence[0], 1);
  }
  void solve(double tolerance) {
    solver->set_target(tolerance * rms_divergence());
    ASSERT_EQ(solver->solve(dt, divergence, pressure, increment), 0);
  }
};

// Owned cells and the ghosts behind sides.
int differences(const OpenScene &s, const OpenScene &one) {
  int count = 0;
  const Layout &own = s.domain.layout();
  for (const Segment &row : s.domain.rows())
    for (int i = 0; i < row.i_end; ++i) {
      const double a = s.increment[0](i, row.j, row.k);
      const double b = one.increment[0](own.begin[0] + i, own.begin[1] + row.j, own.begin[2] + row.k);
      count += std::memcmp(&a, &b, sizeof a) != 0;
    }
  return count;
}

const std::vector<Int3> shapes{{24, 20, 1}, {13, 18, 1}, {16, 12, 14}, {9, 14, 7}};

}  // namespace

TEST(OpenPressure, AllSolversFindTheSame) {
  if (!is_alone()) return;
  for (const Int3 &cells : shapes)
    for (const GridSpec &spec : open_boundaries(cells)) {
      OpenScene exact(PETSC_COMM_SELF, spec, Kind::smac);
      exact.solve(0);
      const double size = exact.rms(exact.increment[0]);
      EXPECT_LT(exact.rms_residual(), 1e-12 * exact.rms_divergence()) << open_name(spec);
      for (const Kind kind : {Kind::sweeps, Kind::remembering, Kind::ksp, Kind::descent}) {
        if (kind == Kind::descent && cells != shapes[0]) continue;
        OpenScene other(PETSC_COMM_SELF, spec, kind);
        other.solve(1e-9);
        EXPECT_LT(other.rms_residual(), 2e-9 * other.rms_divergence()) << open_name(spec) << " " << int(kind);
        const double off =
            other.rms([&](int i, int j, int k) { return other.increment[0](i, j, k) - exact.increment[0](i, j, k); });
        EXPECT_LT(off, 1e-7 * size) << open_name(spec) << " " << int(kind);
      }
    }
}

TEST(OpenPressure, SameBitsOnAnyRanks) {
  for (const Int3 &cells : shapes)
    for (const GridSpec &spec : open_boundaries(cells))
      for (const Kind kind : {Kind::smac, Kind::sweeps, Kind::remembering}) {
        OpenScene one(PETSC_COMM_SELF, spec, kind);
        one.solve(1e-6);
        for (const GridSpec &shared : all_decompositions(spec)) {
          OpenScene many(run_communicator(), shared, kind);
          many.solve(1e-6);
          EXPECT_EQ(differences(many, one), 0) << open_name(shared) << " " << int(kind);
        }
      }
}

// V-cycles converge as between walls: never more sweeps than half as many again.
TEST(OpenPressure, SweepsStayFew) {
  if (!is_alone()) return;
  for (const Int3 &cells : {Int3{64, 64, 1}, Int3{37, 50, 1}, Int3{32, 32, 32}, Int3{19, 21, 26}})
    for (const GridSpec &spec : open_boundaries(cells)) {
      OpenScene scene(PETSC_COMM_SELF, spec, Kind::sweeps);
      scene.solve(1e-6);
      EXPECT_LE(scene.solver->sweeps(), 22) << open_name(spec);
    }
}
