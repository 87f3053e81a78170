// PETSc's KSP against the exact solver: all boundaries and shapes of the grid, iterations, options, failures.
#include "pressure/ksp.hpp"
#include "base/rank_zero.hpp"
#include "pressure/smac.hpp"
#include "support/poisson_scene.hpp"

#include <map>

using namespace eulastic;
using namespace eulastic::test;

namespace {

using Options = std::map<std::string, std::string>;

struct KspScene : PoissonScene {
  Options options;
  KspSolver solver;
  explicit KspScene(const GridSpec &spec, const Options &given = {}, MPI_Comm comm = run_communicator())
      : PoissonScene(comm, spec), options(given) {
    for (const auto &[name, value] : options)
      EXPECT_EQ(PetscOptionsSetValue(nullptr, ("-pressure_" + name).c_str(), value.c_str()), 0);
    EXPECT_EQ(solver.create(domain, *exchange), 0);
  }
  ~KspScene() {
    for (const auto &[name, value] : options) PetscOptionsClearValue(nullptr, ("-pressure_" + name).c_str());
  }
  PetscErrorCode solve() { return solver.solve(dt, divergence, pressure, increment); }
  /// Iterations of one solution.
  long iterations() {
    const long before = solver.sweeps();
    EXPECT_EQ(solve(), 0);
    return solver.sweeps() - before;
  }
  std::string preconditioner() const {
    PC pc;
    PCType type;
    KSPGetPC(solver.ksp(), &pc);
    PCGetType(pc, &type);
    return type;
  }
};

// Like all_decompositions, with x cut anywhere: the KSP claims no bits.
std::vector<GridSpec> any_decomposition(GridSpec spec) {
  int ranks = 0;
  MPI_Comm_size(run_communicator(), &ranks);
  std::vector<GridSpec> specs;
  for (int px = 1; px <= ranks; ++px)
    for (int py = 1; py <= ranks / px; ++py) {
      if (ranks % (px * py)) continue;
      spec.processors = {px, py, ranks / (px * py)};
      add_splits(spec, &specs);
    }
  return specs;
}

// Those of odd numbers or of even ones, if there are several.
std::vector<GridSpec> every_other(const std::vector<GridSpec> &specs, int parity) {
  std::vector<GridSpec> chosen;
  for (std::size_t n = 0; n < specs.size(); ++n)
    if (specs.size() == 1 || n % 2 == static_cast<std::size_t>(parity % 2)) chosen.push_back(specs[n]);
  return chosen;
}

// Boxes of cubes, but for the given sides of the cells.
GridSpec box(const Int3 &cells, int walls, const Real3 &sides = {1, 1, 1}) {
  GridSpec spec;
  spec.cells = cells;
  for (int d = 0; d < 3; ++d) {
    spec.length[d] = 0.1 * sides[d] * cells[d];
    spec.boundary[d] = walls >> d & 1 ? Boundary::wall : Boundary::periodic;
  }
  return spec;
}

// Of -lap, but for 0.
double smallest_eigenvalue(const Domain &domain) {
  double smallest = HUGE_VAL;
  for (int d = 0; d < domain.dimension(); ++d) {
    const double angle = (domain.is_wall(d) ? 1 : 2) * M_PI / domain.domain_cells()[d];
    smallest = std::min(smallest, std::pow(2 * std::sin(angle / 2) / domain.spacing()[d], 2));
  }
  return smallest;
}

double largest(double value) {
  MPI_Allreduce(MPI_IN_PLACE, &value, 1, MPI_DOUBLE, MPI_MAX, run_communicator());
  return value;
}

// Largest |a - b|, ghosts, edges and corners included; infinite if anything is NaN.
double difference(const PoissonScene &s, ConstView a, ConstView b) {
  const int gz = std::min(1, s.domain.layout().ghosts[2]);
  double worst = 0;
  for (int k = -gz; k < s.domain.cells()[2] + gz; ++k)
    for (int j = -1; j < s.domain.cells()[1] + 1; ++j)
      for (int i = -1; i < s.domain.cells()[0] + 1; ++i) {
        const double error = std::abs(a(i, j, k) - b(i, j, k));
        worst = error <= worst ? worst : std::isfinite(error) ? error : HUGE_VAL;
      }
  return largest(worst);
}

std::string message;
PetscErrorCode keep_first(MPI_Comm, int, const char *, const char *, PetscErrorCode code, PetscErrorType type,
                          const char *text, void *) {
  if (type == PETSC_ERROR_INITIAL && text) message = text;
  return code;
}

}  // namespace

// The residual reaches 1e-10, 1 % for CG's residual being a recursion. An error e has lap e = r / dt, hence
// rms(e) <= rms(r) / (dt smallest eigenvalue): no margin is needed. In the largest norm, corners of the ghosts
// included, that costs at most the square root of the number of cells. Every way to share the cells meets all walls,
// with the one sides of the cells or the other.
TEST(Ksp, EqualsSmacOnAllBoundariesAndDecompositions) {
  if (!SmacSolver::available()) GTEST_SKIP() << "built without FFTW";
  for (const Int3 &cells : {Int3{16, 24, 12}, Int3{13, 10, 11}, Int3{16, 24, 1}, Int3{13, 10, 1}})
    for (const Real3 &sides : {Real3{1, 1.3, 1.2}, Real3{1, 3, 0.5}}) {
      const bool cubes = sides[1] < 2;
      const int step = cubes && cells[0] == 16 && cells[2] == 1 ? 1 : 2;
      for (int walls = 0; walls < (cells[2] == 1 ? 4 : 8); walls += step)
        for (const GridSpec &spec : every_other(any_decomposition(box(cells, walls, sides)), walls / step + cubes)) {
          KspScene s(spec);
          s.set(noise);
          EXPECT_LE(s.iterations(), 25) << name(spec);  // thin slabs of unequal cells take most
          EXPECT_LE(s.rms_residual(), 1.01e-10 * s.rms_divergence()) << name(spec);
          // 16, 24, 12 can be halved twice; four ranks along z cannot share three layers, nor can others lopsided.
          const bool geometric = cells[0] == 16 && cubes && s.domain.processors(2) < 4 && spec.starts[0].empty();
          EXPECT_EQ(s.preconditioner(), geometric ? PCMG : PCGAMG) << name(spec);
          std::unique_ptr<PressureSolver> smac;
          Field exact(s.domain, 1);
          ASSERT_EQ(SmacSolver::create(s.domain, *s.exchange, &smac), 0);
          ASSERT_EQ(smac->solve(s.dt, s.divergence, s.pressure, exact), 0);
          const double bound = 1.01e-10 * s.rms_divergence() / (s.dt * smallest_eigenvalue(s.domain));
          const ConstView a = s.increment[0], b = exact[0];
          EXPECT_LE(s.rms([&](int i, int j, int k) { return a(i, j, k) - b(i, j, k); }), bound) << name(spec);
          EXPECT_LE(difference(s, a, b), bound * std::sqrt(s.domain.domain_cell_count())) << name(spec);
        }
    }
}

// Ends of ranks at odd places, narrow ones first and last.
TEST(Ksp, HalvesUnevenRanks) {
  int ranks = 0;
  MPI_Comm_size(run_communicator(), &ranks);
  for (const bool narrow_first : {true, false})
    for (const int walls : {0, 2, 7}) {
      GridSpec spec = box({16, 32, 96}, walls);
      spec.starts = {std::vector<int>{0, 16}, {0, 32}, {0}};
      for (int p = 1; p < ranks; ++p) spec.starts[2].push_back(narrow_first ? 13 * p : 96 - 13 * (ranks - p));
      spec.starts[2].push_back(96);
      KspScene s(spec), even(box({16, 32, 96}, walls));
      s.set(noise);
      even.set(noise);
      EXPECT_EQ(s.preconditioner(), PCMG);
      EXPECT_LE(s.iterations(), 1.3 * even.iterations());  // coarse cells lie across ends of ranks
      EXPECT_LE(s.rms_residual(), 1.01e-10 * s.rms_divergence());
    }
}

TEST(Ksp, IterationsDoNotGrow) {
  for (const int walls : {2, 7}) {
    KspScene s(walls == 2 ? box({64, 64, 64}, walls) : box({48, 48, 48}, walls));
    s.set(noise);
    EXPECT_LE(s.iterations(), 15) << walls;
    EXPECT_LE(s.rms_residual(), 1.01e-10 * s.rms_divergence()) << walls;
  }
  for (const GridSpec &spec : {box({33, 35, 31}, 2), box({48, 48, 24}, 2, {1, 2, 4}), box({256, 64, 1}, 2),
                               box({256, 64, 1}, 0, {1, 8, 1}), box({200, 8, 8}, 2), box({100, 60, 44}, 2)}) {
    KspScene s(spec);
    s.set(noise);
    EXPECT_LE(s.iterations(), 21) << name(spec);
    EXPECT_LE(s.rms_residual(), 1.01e-10 * s.rms_divergence()) << name(spec);
  }
}

TEST(Ksp, UnitsDoNotMatter) {
  GridSpec spec = box({32, 16, 16}, 2);
  KspScene metres(spec);
  metres.set(noise);
  for (double &length : spec.length) length *= 1e-8;
  KspScene nanometres(spec);
  nanometres.set([](int i, int j, int k) { return 1e12 * noise(i, j, k); });
  EXPECT_EQ(metres.iterations(), nanometres.iterations());
  EXPECT_LE(nanometres.rms_residual(), 1.01e-10 * nanometres.rms_divergence());
}

TEST(Ksp, OptionsReachIt) {
  const GridSpec spec = box({32, 32, 16}, 2);
  const auto iterations = [&](const Options &options) {
    KspScene s(spec, options);
    s.set(noise);
    return s.iterations();
  };
  const long preset = iterations({});
  EXPECT_LT(iterations({{"ksp_rtol", "1e-4"}}), preset);
  EXPECT_GT(iterations({{"pc_type", "jacobi"}}), 2 * preset);
  EXPECT_GT(iterations({{"mg_levels_ksp_max_it", "1"}}), preset);
  EXPECT_EQ(iterations({{"ksp_type", "preonly"}}), 1);
  for (const Options &options : {Options{{"ksp_type", "fgmres"}}, Options{{"ksp_type", "bcgs"}, {"pc_type", "bjacobi"}},
                                 Options{{"pc_mg_levels", "2"}, {"mg_coarse_pc_type", "gamg"}},
                                 Options{{"ksp_guess_type", "fischer"}}, Options{{"ksp_type", "minres"}}}) {
    KspScene s(spec, options);
    s.set(noise);
    EXPECT_EQ(s.solve(), 0) << options.begin()->second;
    EXPECT_LE(s.rms_residual(), 1e-8 * s.rms_divergence()) << options.begin()->second;  // other norms
  }
}

TEST(Ksp, SaysWhichOptionHelpsWhereItDoesNotConverge) {
  KspScene s(box({16, 16, 16}, 2), {{"ksp_max_it", "3"}});
  s.set(noise);
  PetscPushErrorHandler(keep_first, nullptr);
  const PetscErrorCode code = s.solve();
  PetscPopErrorHandler();
  EXPECT_NE(code, 0);
  EXPECT_NE(message.find("-pressure_ksp_max_it (now 3)"), std::string::npos) << message;
  EXPECT_NE(message.find("DIVERGED_ITS"), std::string::npos) << message;
}

// What no pressure can remove, and nothing to remove.
TEST(Ksp, IgnoresTheMean) {
  for (const int walls : {0, 7}) {
    KspScene s(box({16, 12, 20}, walls));
    s.set([](int i, int j, int k) { return 5 + noise(i, j, k); }, false);
    const double mean = global_sum(s.domain, s.divergence[0]) / s.domain.domain_cell_count();
    EXPECT_EQ(s.solve(), 0);
    EXPECT_LE(s.rms([&](int i, int j, int k) { return s.residual(i, j, k) - mean; }), 1e-9);
    EXPECT_LE(std::abs(global_sum(s.domain, s.increment[0])) / s.domain.domain_cell_count(), 1e-16);
    for (const double constant : {0.0, 5.0, 0.1}) {
      s.set([&](int, int, int) { return constant; }, false);
      EXPECT_EQ(s.solve(), 0) << constant;
      EXPECT_LE(s.rms(s.increment[0]), 1e-15) << constant;
    }
  }
}

// The time loop then ends the run for that reason.
TEST(Ksp, AnswersNotANumberInKind) {
  KspScene s(box({16, 12, 20}, 2));
  s.set([](int i, int j, int k) { return i + j + k == 3 ? NAN : 1.0; }, false);
  EXPECT_EQ(s.solve(), 0);
  EXPECT_TRUE(std::isnan(s.increment[0](0, 0, 0)));
  s.set(noise);
  EXPECT_EQ(s.solve(), 0);
  EXPECT_LE(s.rms_residual(), 1.01e-10 * s.rms_divergence());
}
