// The V-cycle: its transfers, its linearity, a number of iterations that does not grow with the grid, and the least
// squares.
#include "pressure/acm_iterations.hpp"
#include "support/poisson_scene.hpp"

#include <cstdio>

using namespace eulastic;
using namespace eulastic::test;

namespace {

GridSpec box(const Int3 &cells, const Real3 &length, bool x, bool y, bool z) {
  GridSpec spec;
  spec.cells = cells;
  spec.length = length;
  const bool wall[3] = {x, y, z};
  for (int d = 0; d < 3; ++d) spec.boundary[d] = wall[d] ? Boundary::wall : Boundary::periodic;
  return spec;
}

struct Convergence {
  int sweeps = 0;     // iterations to 1e-4
  double first = 0;   // residual after the first iteration
  double factor = 0;  // mean factor of later iterations, to 1e-8
};

Convergence convergence(const GridSpec &spec) {
  const auto f = [&](int i, int j, int k) {
    const double x = 2 * M_PI * (i + 0.5) / spec.cells[0], y = 2 * M_PI * (j + 0.5) / spec.cells[1];
    return noise(i, j, k) + std::cos(x) + std::cos(y) + std::cos(x) * std::cos(y) +
           std::cos(M_PI * (k + 0.5) / spec.cells[2]);
  };
  Convergence result;
  double left[2] = {};
  long sweeps[2] = {};
  for (const double target : {1e-4, 1e-8, 1.0}) {
    PoissonScene s(PETSC_COMM_SELF, spec);
    s.set(f);
    AcmIterativeSolver solver;
    WorkSpace work(s.domain);
    EXPECT_EQ(solver.create(s.domain, *s.exchange, {30, 0, true}, work), 0);
    solver.set_target(target * s.rms_divergence());
    EXPECT_EQ(solver.solve(s.dt, s.divergence, s.pressure, s.increment), 0);
    const double relative = s.rms_residual() / s.rms_divergence();
    EXPECT_LE(relative, target * 1.001);
    if (target == 1e-4) result.sweeps = static_cast<int>(solver.sweeps());
    if (target == 1.0) result.first = relative;
    left[target == 1.0] = relative;
    sweeps[target == 1.0] = solver.sweeps();
  }
  result.factor = std::pow(left[0] / left[1], 1.0 / (sweeps[0] - sweeps[1]));
  return result;
}

Convergence show(const GridSpec &spec) {
  const Convergence c = convergence(spec);
  std::printf("%s%.3g x %.3g x %.3g: %d sweeps to 1e-4, first %.3f, then %.3f\n", name(spec).c_str(), spec.length[0],
              spec.length[1], spec.length[2], c.sweeps, c.first, c.factor);
  return c;
}

}  // namespace

TEST(Multigrid, SweepsDoNotGrowWithTheGrid) {
  for (const bool wall : {false, true}) {
    int sweeps = 0;
    for (const int n : {32, 64, 128, 256}) {
      const Convergence c = show(box({n, n, 1}, {1, 1, 1}, wall, true, false));
      if (n == 32) sweeps = c.sweeps;
      EXPECT_LE(c.sweeps, sweeps + 1);
      EXPECT_LE(c.sweeps, 4);
      EXPECT_LE(c.factor, 0.15);
    }
    for (const int n : {16, 32, 64, 128}) {
      const Convergence c = show(box({n, n, n}, {1, 1, 1}, wall, true, false));
      if (n == 16) sweeps = c.sweeps;
      EXPECT_LE(c.sweeps, sweeps + 1);
      EXPECT_LE(c.sweeps, 5);
      EXPECT_LE(c.factor, 0.15);
    }
  }
}

// Convergence is slower with an odd last cell, but bounded.
TEST(Multigrid, OddCellsAndUnequalSpacings) {
  for (const int n : {31, 33, 63, 65, 127, 129, 101})
    for (const bool wall : {false, true}) EXPECT_LE(show(box({n, n, 1}, {1, 1, 1}, wall, wall, false)).factor, 0.25);
  for (const Int3 &cells : {Int3{31, 31, 31}, Int3{33, 33, 33}, Int3{13, 10, 11}, Int3{45, 27, 39}})
    for (const bool wall : {false, true}) EXPECT_LE(show(box(cells, {1, 1, 1}, wall, wall, wall)).factor, 0.35);
  for (const Real3 &length :
       {Real3{1.7, 0.9, 2.3}, Real3{1, 2, 4}, Real3{1, 1, 1.3}, Real3{1, 1, 0.75}, Real3{1, 1, 20}, Real3{1, 20, 20}})
    EXPECT_LE(show(box({32, 32, 32}, length, false, true, false)).factor, 0.25);
}

TEST(Multigrid, IsLinear) {
  for (const GridSpec &spec : all_boundaries({13, 18, 11})) {
    PoissonScene s(PETSC_COMM_SELF, spec);
    Multigrid multigrid;
    ASSERT_EQ(multigrid.create(s.domain), 0);
    Field result[3] = {Field(s.domain, 1), Field(s.domain, 1), Field(s.domain, 1)}, scratch(s.domain, 1);
    const CellFunction f[3] = {noise, [](int i, int j, int k) { return noise(k, i + 5, j); },
                               [](int i, int j, int k) { return noise(i, j, k) - 3 * noise(k, i + 5, j); }};
    for (int m = 0; m < 3; ++m) {
      s.set(f[m]);
      ASSERT_EQ(s.exchange->update_ghosts(s.divergence, Multigrid::halo), 0);
      ASSERT_EQ(multigrid.apply(s.divergence, result[m], scratch), 0);
    }
    const double size = s.rms(result[2][0]);
    EXPECT_GT(size, 0);
    EXPECT_LT(s.rms([&](int i, int j, int k) {
      return result[0][0](i, j, k) - 3 * result[1][0](i, j, k) - result[2][0](i, j, k);
    }),
              1e-13 * size)
        << name(spec);
  }
}

// Volume shares add up to one, parents and children agree, and interpolation is exact for linear functions wherever
// there is a neighbour to interpolate from, also beside a last cell of one or three.
TEST(Multigrid, TransfersAreConservativeAndLinear) {
  for (int n = 3; n <= 40; ++n) {
    Domain domain;
    ASSERT_EQ(domain.create(PETSC_COMM_SELF, box({n, n, 1}, {1, 1, 1}, true, true, false)), 0);
    std::vector<double> ones(n, 1.0);
    auto fine = std::make_unique<MultigridLevel>(Partition(domain), MultigridLevel::Widths{ones, ones, {1.0}},
                                                 domain.spacing());
    std::vector<double> width(ones);
    while (!fine->single_cell()) {
      auto coarse = fine->coarser();
      const LineTransfer line = fine->transfer(*coarse, 0);
      const int cells = coarse->box().domain_cells()[0];
      std::vector<double> coarse_width(cells), coarse_centre(cells);
      for (std::size_t i = 0; i < width.size(); ++i) coarse_width[line.parent[i]] += width[i];
      double edge = 0;
      for (int I = 0; I < cells; ++I) {
        double sum = 0;
        for (int m = 0; m < 3; ++m) {
          sum += line.weight[m][I];
          if (line.weight[m][I] > 0) {
            EXPECT_EQ(line.parent[line.first + line.stride * I + m], I);
          }
        }
        EXPECT_NEAR(sum, 1, 1e-15);
        EXPECT_TRUE(coarse_width[I] >= 0.5 * coarse_width[0] && coarse_width[I] <= 2 * coarse_width[0]) << n;
        coarse_centre[I] = edge + coarse_width[I] / 2;
        edge += coarse_width[I];
      }
      edge = 0;
      for (std::size_t i = 0; i < width.size(); ++i) {
        const double centre = edge + width[i] / 2, at = coarse_centre[line.parent[i]];
        edge += width[i];
        // Beyond the outermost centres and at a single cell there is no neighbour to interpolate from.
        const bool inside = centre >= coarse_centre[0] && centre <= coarse_centre[cells - 1];
        if (inside) {
          EXPECT_NEAR(at + line.share[i] * (coarse_centre[line.neighbour[i]] - at), centre, 1e-12 * n);
        } else {
          EXPECT_EQ(line.share[i], 0);
        }
      }
      width = coarse_width;
      fine = std::move(coarse);
    }
  }
}

// Comparison with normal equations of small vectors, solved by hand or known by construction.
TEST(Minimise, FindsTheLeastSquaresAndItsGuards) {
  LeastSquaresSums s;
  s.directions = 2;  // L_0 = (1, 0, 0), L_1 = (1, 2, 0), D = (3, 4, 5) = 1 L_0 + 2 L_1 + (0, 0, 5)
  s.square = 50;
  s.with[0] = 3;
  s.with[1] = 11;
  s.product[0][0] = 1;
  s.product[1][0] = 1;
  s.product[1][1] = 5;
  LeastSquaresSolution m = minimise(s);
  EXPECT_DOUBLE_EQ(m.coefficient[0], 1);
  EXPECT_DOUBLE_EQ(m.coefficient[1], 2);
  EXPECT_DOUBLE_EQ(m.square, 25);

  s.directions = 3;  // a direction that is zero before one that counts, and one that repeats L_0
  s.product[2][0] = s.product[2][2] = s.product[0][0];
  s.product[2][1] = s.product[1][0];
  s.with[2] = s.with[0];
  m = minimise(s);
  EXPECT_DOUBLE_EQ(m.coefficient[0], 1);
  EXPECT_DOUBLE_EQ(m.coefficient[1], 2);
  EXPECT_EQ(m.coefficient[2], 0);
  EXPECT_DOUBLE_EQ(m.square, 25);

  LeastSquaresSums zero_first;
  zero_first.directions = 2;
  zero_first.square = 9;
  zero_first.with[1] = 6;
  zero_first.product[1][1] = 4;
  m = minimise(zero_first);
  EXPECT_EQ(m.coefficient[0], 0);
  EXPECT_DOUBLE_EQ(m.coefficient[1], 1.5);
  EXPECT_GT(m.square, 0);  // exactly solved, but never trusted beyond the rounding of the sums
  EXPECT_LE(m.square, 9e-14 * 1.001);

  m = minimise(LeastSquaresSums{});
  EXPECT_EQ(m.coefficient[0], 0);
  EXPECT_EQ(m.square, 0);
  s.square = std::nan("");
  EXPECT_TRUE(std::isnan(minimise(s).coefficient[0]));
  s.square = 50;
  s.product[1][1] = std::nan("");
  EXPECT_TRUE(std::isnan(minimise(s).coefficient[0]));
}

// For any number of ranks: after halving, each rank has at least two cells of a direction that is shared; no rank ever
// has more cells than on the finest level; and the level that goes to every rank is small.
TEST(Multigrid, LevelsOnManyRanks) {
  int joined = 0;
  for (const auto &[cells, ranks] : {std::pair<Int3, int>{{24576, 5184, 5120}, 82944},
                                     {{4096, 1024, 1024}, 8192},
                                     {{1000, 700, 900}, 1001},
                                     {{64, 64, 64}, 256},
                                     {{64, 64, 64}, 27},
                                     {{1024, 1024, 1}, 1024},
                                     {{64, 64, 64}, 4}}) {
    const Domain domain = Domain::planned(box(cells, {1, 1, 1}, false, true, false), ranks);
    const auto levels = Multigrid::plan(domain);
    const auto most = [](const Split &split) {  // cells of a rank
      double product = 1;
      for (int d = 0; d < 3; ++d) {
        int along = 0;
        for (int p = 0; p < split.parts(d); ++p) along = std::max(along, split.cells_along(d, p));
        product *= along;
      }
      return product;
    };
    EXPECT_TRUE(levels.back()->single_cell());
    for (std::size_t l = 1; l < levels.size(); ++l) {
      const Box &fine = levels[l - 1]->box(), &next = levels[l]->box();
      const Split &before = levels[l - 1]->partition().split(), &after = levels[l]->partition().split();
      if (levels[l]->partition().ranks() == 1) {
        EXPECT_LE(fine.domain_cell_count(), 4096);
        break;
      }
      EXPECT_EQ(levels[l]->partition().ranks(), ranks);
      EXPECT_LE(most(after), std::max(most(domain.split()), 4096.0))
          << next.domain_cells()[0] << " x " << next.domain_cells()[1];
      joined += next.domain_cells() == fine.domain_cells();
      for (int d = 0; d < 3; ++d)
        for (int p = 0; next.domain_cells() != fine.domain_cells() && p < domain.processors(d); ++p) {
          const int had = before.cells_along(d, p), has = after.cells_along(d, p);
          EXPECT_TRUE(had == 0 ? has == 0 : has >= 2 || had == fine.domain_cells()[d]);
        }
    }
  }
  EXPECT_GE(joined, 6);
}
