// The exact pressure solver: residual, ghosts, known modes, and the same bits on any decomposition.
#include "pressure/smac.hpp"
#include "base/exact_sum.hpp"
#include "base/rank_zero.hpp"
#include "diagnostics/state_hash.hpp"
#include "field/boundaries.hpp"
#include "support/lopsided.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <functional>

using namespace eulastic;

namespace {

using Function = std::function<double(int, int, int)>;  // of the global cell

constexpr double dt = 0.37;

// Random in (-1, 1), a function of the global index alone.
double noise(int i, int j, int k) {
  const double x = 43758.5453 * std::sin(12.9898 * i + 78.233 * j + 37.719 * k);
  return 2 * (x - std::floor(x)) - 1;
}

// One solution with all that belongs to it.
struct Solution {
  Domain domain;
  std::unique_ptr<GhostExchange> exchange;
  std::unique_ptr<PressureSolver> solver;
  Field divergence, pressure, increment;

  Solution(MPI_Comm comm, const GridSpec &spec, const Function &f) {
    EXPECT_EQ(domain.create(comm, spec), 0);
    exchange = std::make_unique<GhostExchange>(domain);
    divergence = Field(domain, 1);
    pressure = Field(domain, 1);
    increment = Field(domain, 1);
    const Layout &own = domain.layout();
    for (int k = 0; k < own.cells[2]; ++k)
      for (int j = 0; j < own.cells[1]; ++j)
        for (int i = 0; i < own.cells[0]; ++i)
          divergence[0](i, j, k) = f(own.begin[0] + i, own.begin[1] + j, own.begin[2] + k);
    EXPECT_EQ(SmacSolver::create(domain, *exchange, &solver), 0);
    solve();
  }
  void solve() {
    increment.fill(0, std::nan(""));  // so that a ghost nobody filled shows
    EXPECT_EQ(solver->solve(dt, divergence, pressure, increment), 0);
  }
  // g(i, j, k) of local cells, with `ghosts` layers more where they exist.
  template <class G>
  void each(int ghosts, const G &g) const {
    const Layout &own = domain.layout();
    const int gz = std::min(ghosts, own.ghosts[2]);
    for (int k = -gz; k < own.cells[2] + gz; ++k)
      for (int j = -ghosts; j < own.cells[1] + ghosts; ++j)
        for (int i = -ghosts; i < own.cells[0] + ghosts; ++i) g(i, j, k);
  }
};

double largest(double value) {
  MPI_Allreduce(MPI_IN_PLACE, &value, 1, MPI_DOUBLE, MPI_MAX, run_communicator());
  return value;
}

double mean(const Domain &domain, ConstView field) {
  ExactSums sum(1);
  for (const Segment &s : domain.rows()) sum.add_row(0, field.row(s.j, s.k), s.size(), domain.layout().begin[0]);
  double value = 0;
  EXPECT_EQ(sum.reduce(domain.comm(), &value), 0);
  return value / domain.domain_cell_count();
}

// r = lap(increment) - (divergence - <divergence>) / dt, infinite if anything is NaN; f = divergence / dt.
struct Residual {
  double relative;  // max |r| / max |f|
  double backward;  // max |r| / (max |f| + sum 4/h^2 max |increment|), the natural measure of rounding
};

Residual residual(const Solution &s) {
  const Real3 &h = s.domain.spacing();
  const ConstView q = s.increment[0], f = s.divergence[0];
  const double average = mean(s.domain, f);
  const bool flat = s.domain.dimension() == 2;
  double r_max = 0, f_max = 0, q_max = 0;
  s.each(0, [&](int i, int j, int k) {
    double laplacian = (q(i - 1, j, k) - 2 * q(i, j, k) + q(i + 1, j, k)) / (h[0] * h[0]) +
                       (q(i, j - 1, k) - 2 * q(i, j, k) + q(i, j + 1, k)) / (h[1] * h[1]);
    if (!flat) laplacian += (q(i, j, k - 1) - 2 * q(i, j, k) + q(i, j, k + 1)) / (h[2] * h[2]);
    const double r = std::abs(laplacian - (f(i, j, k) - average) / dt);
    r_max = r <= r_max ? r_max : std::isfinite(r) ? r : HUGE_VAL;
    f_max = std::max(f_max, std::abs(f(i, j, k)) / dt);
    q_max = std::max(q_max, std::abs(q(i, j, k)));
  });
  const double stiffness = 4 / (h[0] * h[0]) + 4 / (h[1] * h[1]) + (flat ? 0 : 4 / (h[2] * h[2]));
  r_max = largest(r_max);
  f_max = largest(f_max);
  return {r_max / f_max, r_max / (f_max + stiffness * largest(q_max))};
}

// Cells and ghosts of `s` that differ in any bit from the periodic or mirror image in the solution `one` of one rank.
int differences(const Solution &s, const Solution &one) {
  int count = 0;
  s.each(1, [&](int i, int j, int k) {
    const Int3 local{i, j, k};
    Int3 image{};
    for (int d = 0; d < 3; ++d) {
      const int n = s.domain.domain_cells()[d], g = s.domain.layout().begin[d] + local[d];
      image[d] = !s.domain.is_wall(d) ? (g + n) % n : g < 0 ? -1 - g : g >= n ? 2 * n - 1 - g : g;
    }
    const double a = s.increment[0](i, j, k), b = one.increment[0](image[0], image[1], image[2]);
    count += std::memcmp(&a, &b, sizeof a) != 0;
  });
  return count;
}

std::vector<GridSpec> all_boundaries(const Int3 &cells) {
  std::vector<GridSpec> specs;
  for (int walls = 0; walls < (cells[2] == 1 ? 4 : 8); ++walls) {
    GridSpec spec;
    spec.cells = cells;
    spec.length = {1.7, 0.9, 2.3};
    for (int d = 0; d < 3; ++d) spec.boundary[d] = walls >> d & 1 ? Boundary::wall : Boundary::periodic;
    specs.push_back(spec);
  }
  return specs;
}

// Every way to share the cells of `spec` among the ranks of this run.
std::vector<GridSpec> all_decompositions(GridSpec spec) {
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

std::string name(const GridSpec &s) {
  std::string text;
  for (int d = 0; d < 3; ++d)
    text += std::to_string(s.cells[d]) + (s.boundary[d] == Boundary::wall ? " wall" : " periodic") + " on " +
            std::to_string(s.processors[d]) + "; ";
  return text;
}

}  // namespace

class Smac : public ::testing::Test {
protected:
  void SetUp() override {
    if (!SmacSolver::available()) GTEST_SKIP() << "built without FFTW";
  }
};

TEST(SmacAvailability, CreateFailsExactlyWithoutFftw) {
  Domain domain;
  ASSERT_EQ(domain.create(run_communicator(), all_boundaries({12, 12, 12})[0]), 0);
  GhostExchange exchange(domain);
  std::unique_ptr<PressureSolver> solver;
  PetscPushErrorHandler(PetscReturnErrorHandler, nullptr);
  const PetscErrorCode code = SmacSolver::create(domain, exchange, &solver);
  PetscPopErrorHandler();
  EXPECT_EQ(code == 0, SmacSolver::available());
  EXPECT_EQ(solver != nullptr, SmacSolver::available());
}

// Transforms and elimination are backward stable: the residual is a few eps (|f| + sum 4/h^2 |q|). For noise the
// second term is at most about ten times the first on these grids, and eps log2(N) = 1e-15: 1e-13 leaves a margin of
// ten, while any wrong eigenvalue, ghost or coupling gives 1e-3 or more. Same bits: every cell and every ghost, edges
// and corners too, equals the one-rank solution exactly.
TEST_F(Smac, RandomRightHandSideOnAllBoundariesAndDecompositions) {
  for (const Int3 &cells : {Int3{13, 10, 11}, Int3{16, 24, 12}, Int3{13, 10, 1}, Int3{16, 24, 1}})
    for (const GridSpec &spec : all_boundaries(cells)) {
      const Solution one(PETSC_COMM_SELF, spec, noise);
      const std::vector<GridSpec> decompositions = all_decompositions(spec);
      ASSERT_FALSE(decompositions.empty());
      for (const GridSpec &shared : decompositions) {
        const Solution many(run_communicator(), shared, noise);
        EXPECT_LT(residual(many).relative, 1e-13) << name(shared);
        EXPECT_LT(std::abs(mean(many.domain, many.increment[0])), 1e-16) << name(shared);
        EXPECT_EQ(differences(many, one), 0) << name(shared);
      }
    }
}

// Large primes and powers of two take other paths through FFTW; 520 cells are split in whole blocks. Long lines make
// |q| large, so here the backward error is asserted: below 2e-15, that is eps log2(N).
TEST_F(Smac, SameBitsForOtherTransformLengths) {
  for (const Int3 &cells :
       {Int3{67, 13, 12}, Int3{12, 14, 97}, Int3{256, 12, 13}, Int3{15, 13, 128}, Int3{101, 19, 1}, Int3{520, 13, 1}})
    for (const Boundary b : {Boundary::periodic, Boundary::wall}) {
      GridSpec spec = all_boundaries(cells)[0];
      spec.boundary = {b, Boundary::wall, b};
      const Solution one(PETSC_COMM_SELF, spec, noise);
      for (const GridSpec &shared : all_decompositions(spec)) {
        const Solution many(run_communicator(), shared, noise);
        EXPECT_LT(residual(many).backward, 2e-15) << name(shared);
        EXPECT_EQ(differences(many, one), 0) << name(shared);
      }
    }
}

// The product of cosines is an eigenvector: periodic cos(2 pi m i / N), walls cos(pi m (i + 1/2) / N).
TEST_F(Smac, SolvesEigenmodesExactly) {
  for (const GridSpec &spec : all_boundaries({14, 12, 13}))
    for (const Int3 &m : {Int3{1, 0, 0}, Int3{0, 1, 0}, Int3{0, 0, 1}, Int3{3, 2, 1}, Int3{6, 5, 4}}) {
      double eigenvalue = 0;
      for (int d = 0; d < 3; ++d) {
        const double h = spec.length[d] / spec.cells[d];
        const double angle = (spec.boundary[d] == Boundary::wall ? 1 : 2) * M_PI * m[d] / spec.cells[d];
        eigenvalue += (2 * std::cos(angle) - 2) / (h * h);
      }
      const auto mode = [&](int i, int j, int k) {
        const Int3 cell{i, j, k};
        double value = 1;
        for (int d = 0; d < 3; ++d)
          value *= spec.boundary[d] == Boundary::wall ? std::cos(M_PI * m[d] * (cell[d] + 0.5) / spec.cells[d])
                                                      : std::cos(2 * M_PI * m[d] * cell[d] / spec.cells[d]);
        return value;
      };
      const Solution s(run_communicator(), spec, [&](int i, int j, int k) { return eigenvalue * dt * mode(i, j, k); });
      double worst = 0;
      s.each(0, [&](int i, int j, int k) {
        const Int3 &begin = s.domain.layout().begin;
        const double error = std::abs(s.increment[0](i, j, k) - mode(begin[0] + i, begin[1] + j, begin[2] + k));
        worst = error <= worst ? worst : std::isfinite(error) ? error : HUGE_VAL;
      });
      // Rounding in f, of size eps |eigenvalue|, is amplified by at most the ratio of the outermost eigenvalues.
      EXPECT_LT(largest(worst), 1e-13) << name(spec) << m[0] << m[1] << m[2];
    }
}

// A constant is no divergence that any pressure could remove: it is left out, and solving again repeats the bits.
TEST_F(Smac, IgnoresTheMeanAndRepeatsItself) {
  for (const GridSpec &spec : all_boundaries({13, 12, 12})) {
    Solution s(run_communicator(), spec, [](int i, int j, int k) { return 5 + noise(i, j, k); });
    EXPECT_LT(residual(s).relative, 1e-13) << name(spec);
    const std::uint64_t first = hash_points(s.domain, s.increment[0], at_centre, 1);
    s.solve();
    EXPECT_EQ(hash_points(s.domain, s.increment[0], at_centre, 1), first) << name(spec);
    Solution constant(run_communicator(), spec, [](int, int, int) { return 5.0; });
    double worst = 0;
    constant.each(1, [&](int i, int j, int k) { worst = std::max(worst, std::abs(constant.increment[0](i, j, k))); });
    EXPECT_LT(largest(worst), 1e-15) << name(spec);
  }
}

#ifdef EULASTIC_HAVE_FFTW
// What "the same bits" rests on: the place of a line in its batch, and its neighbours there, do not matter.
TEST_F(Smac, PlaceInTheBatchDoesNotMatter) {
  for (int n = 3; n <= 400; n += n < 140 ? 1 : 13)
    for (const Boundary boundary : {Boundary::periodic, Boundary::wall}) {
      LineTransform transform;
      ASSERT_EQ(transform.create(boundary, n), 0);
      constexpr int batch = LineTransform::batch;
      std::vector<double> line(n), lines(batch * n);
      for (int m = 0; m < n; ++m) line[m] = noise(m, 0, 0);
      for (int l = 0; l < batch; ++l)
        for (int m = 0; m < n; ++m) lines[l * n + m] = line[m];
      transform.forward(line.data(), 1, n, 1);
      transform.forward(lines.data(), batch, n, 1);
      for (int l = 0; l < batch; ++l)
        EXPECT_EQ(std::memcmp(&lines[l * n], line.data(), n * sizeof(double)), 0) << n << " forward, line " << l;
      transform.backward(line.data(), 1, n, 1);
      transform.backward(lines.data(), batch, n, 1);
      for (int l = 0; l < batch; ++l)
        EXPECT_EQ(std::memcmp(&lines[l * n], line.data(), n * sizeof(double)), 0) << n << " backward, line " << l;
    }
}
#endif
