// Ghost exchange: every ghost inside the domain and across periodic sides, at odd sizes, in every decomposition.
#include "base/rank_zero.hpp"
#include "field/boundaries.hpp"
#include "field/carried_tensor.hpp"
#include "field/ghost_exchange.hpp"
#include "grid/domain.hpp"
#include "pressure/multigrid_level.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <functional>
#include <limits>

namespace eulastic {
namespace {

constexpr double poison = std::numeric_limits<double>::quiet_NaN();

double truth(int f, int i, int j, int k) { return 1 + i + 64 * j + 4096.0 * k + 262144.0 * f; }

// Each sentinel is another negative number, so that a copy of one is noticed as well.
double sentinel(std::ptrdiff_t offset) { return -1.0 - static_cast<double>(offset); }

// Calls `visit` for each decomposition, boundary and size that fits on these ranks.
void for_each_grid(const std::function<void(const Domain &)> &visit) {
  int ranks = 0, visited = 0, split_x = 0;
  MPI_Comm_size(run_communicator(), &ranks);
  for (const Int3 &cells : {Int3{13, 10, 11}, Int3{5, 9, 7}, Int3{17, 12, 1}, Int3{3, 12, 3}, Int3{12, 3, 1}})
    for (int sides = 0; sides < (cells[2] == 1 ? 4 : 8); ++sides)
      for (int px = 1; px <= ranks; ++px)
        for (int py = 1; py <= ranks; ++py) {
          GridSpec spec;
          spec.cells = cells;
          for (int d = 0; d < 3; ++d) spec.boundary[d] = sides >> d & 1 ? Boundary::wall : Boundary::periodic;
          spec.processors = {px, py, 0};
          if (!Domain::refusal_reason(spec, ranks).empty()) continue;
          Domain domain;
          ASSERT_EQ(domain.create(run_communicator(), spec), 0);
          SCOPED_TRACE(::testing::Message()
                       << cells[0] << " x " << cells[1] << " x " << cells[2] << " on " << domain.processors(0) << " x "
                       << domain.processors(1) << " x " << domain.processors(2) << ", walls " << sides);
          visit(domain);
          ++visited;
          split_x += domain.processors(0) > 1;
        }
  EXPECT_GE(visited, 30);
  EXPECT_GE(split_x, ranks > 1 ? 16 : 0);
}

template <class Visit>
void for_each_point(const Layout &own, int fields, const Visit &visit) {
  for (int f = 0; f < fields; ++f)
    for (int k = -own.ghosts[2]; k < own.cells[2] + own.ghosts[2]; ++k)
      for (int j = -own.ghosts[1]; j < own.cells[1] + own.ghosts[1]; ++j)
        for (int i = -own.ghosts[0]; i < own.cells[0] + own.ghosts[0]; ++i) visit(f, Int3{i, j, k});
}

bool is_owned(const Box &box, const Int3 &local) {
  for (int d = 0; d < 3; ++d)
    if (local[d] < 0 || local[d] >= box.points_end(d, true) || box.cells()[d] == 0) return false;
  return true;
}

void prepare(const Box &box, Field &block) {
  const Layout &own = box.layout();
  for (std::ptrdiff_t n = 0; n < own.size * block.count(); ++n) block.data()[n] = sentinel(n);
  for_each_point(own, block.count(), [&](int f, const Int3 &p) {
    if (is_owned(box, p))
      block[f](p[0], p[1], p[2]) = truth(f, own.begin[0] + p[0], own.begin[1] + p[1], own.begin[2] + p[2]);
  });
}

// Whether row (j, k) is a ghost row that an exchange brings, and x whole: it comes with what lies behind its ends.
bool comes_whole(const Box &box, int width, int j, int k) {
  const int row[3] = {0, j, k};
  for (int d = 1; d < 3; ++d) {
    const Box::Range near = box.points_with_ghosts(d, true, width);
    if (row[d] < near.begin || row[d] >= near.end) return false;
  }
  return box.whole_rows() && !is_owned(box, {0, j, k});
}

// Wrong values anywhere in the memory of the block. A rank without cells gets no ghosts.
int count_errors(const Box &box, const Field &block, int width) {
  const Layout &own = box.layout();
  std::vector<double> expected(own.size * block.count());
  for (std::size_t n = 0; n < expected.size(); ++n) expected[n] = sentinel(n);
  for (int f = 0; f < block.count(); ++f)
    for (int k = -own.ghosts[2]; k <= own.cells[2] + own.ghosts[2]; ++k)
      for (int j = -own.ghosts[1]; j <= own.cells[1] + own.ghosts[1]; ++j)
        for (std::ptrdiff_t n = own.offset(-own.ghosts[0], j, k);
             comes_whole(box, width, j, k) && n < own.offset(-own.ghosts[0], j + 1, k); ++n)
          expected[n + f * own.size] = block.data()[n + f * own.size];
  for_each_point(own, block.count(), [&](int f, const Int3 &p) {
    if (box.cell_count() == 0) return;
    Int3 global{};
    for (int d = 0; d < 3; ++d) {
      const int n = box.domain_cells()[d], g = own.begin[d] + p[d];
      if (p[d] < -width || p[d] >= own.cells[d] + width) return;
      if (box.is_wall(d) && (g < 0 || g > n)) return;
      global[d] = box.is_wall(d) ? g : (g % n + n) % n;
    }
    expected[own.offset(p[0], p[1], p[2]) + f * own.size] = truth(f, global[0], global[1], global[2]);
  });
  int errors = 0;
  for (std::size_t n = 0; n < expected.size(); ++n) errors += block.data()[n] != expected[n];
  return errors;
}

// Ghosts get the right value; owned points and rows, ghost rows behind walls and outer ones keep theirs.
TEST(GhostExchange, FillsTheGhostsAndNothingElse) {
  for_each_grid([](const Domain &domain) {
    GhostExchange exchange(domain);
    for (const int fields : {1, 3, 7})
      for (const int width : {1, 2, 3, 4, 5}) {
        Field block(domain, fields);
        prepare(domain, block);
        ASSERT_EQ(exchange.update_ghosts(block, width), 0);
        EXPECT_EQ(count_errors(domain, block, width), 0) << fields << " fields, width " << width;
      }
  });
}

// Boxes of thousands of values, as in runs.
TEST(GhostExchange, FillsThoseOfLargeBoxes) {
  for (const Int3 &cells : {Int3{56, 130, 17}, Int3{42, 57, 56}, Int3{2100, 13, 1}})
    for (const Boundary x : {Boundary::periodic, Boundary::wall})
      for (const Boundary y : {Boundary::periodic, Boundary::wall}) {
        GridSpec spec;
        spec.cells = cells;
        spec.boundary = {x, y, Boundary::periodic};
        Domain domain;
        ASSERT_EQ(domain.create(run_communicator(), spec), 0);
        GhostExchange exchange(domain);
        Field block(domain, 3);
        prepare(domain, block);
        ASSERT_EQ(exchange.update_ghosts(block, 3), 0);
        EXPECT_EQ(count_errors(domain, block, 3), 0) << cells[0] << " cells in a row";
      }
}

// Levels of multigrid: ranks begin anywhere, some have fewer cells than ghosts, or none.
TEST(GhostExchange, FillsThoseOfCoarseGrids) {
  for_each_grid([](const Domain &domain) {
    Int3 cells = domain.domain_cells();
    std::unique_ptr<MultigridLevel> level;
    for (int halvings = 0; halvings <= 3; ++halvings) {
      MultigridLevel::Widths widths;
      for (int d = 0; d < 3; ++d) widths[d].assign(cells[d], 1.0);
      level = std::make_unique<MultigridLevel>((level ? level->partition() : Partition(domain)).coarse(cells), widths,
                                               domain.spacing());
      for (const int width : {1, 3}) {
        Field block(level->box(), 1);
        prepare(level->box(), block);
        ASSERT_EQ(level->exchange().update_ghosts(block, width), 0);
        EXPECT_EQ(count_errors(level->box(), block, width), 0) << halvings << " halvings, width " << width;
      }
      for (int &n : cells) n = (n + 1) / 2;
    }
  });
}

TEST(GhostExchange, KeepsSeveralBlocksInFlight) {
  for_each_grid([](const Domain &domain) {
    GhostExchange exchange(domain);
    Field a(domain, 3), b(domain, 3), c(domain, 1), d(domain, 3);
    for (Field *block : {&a, &b, &c, &d}) prepare(domain, *block);
    for (std::ptrdiff_t n = 0; n < domain.layout().size * 3; ++n) b.data()[n] *= 2;  // the twin of a must not get a's
    for (const GhostUpdate &wanted : {GhostUpdate{&a, 3}, GhostUpdate{&b, 3}})
      ASSERT_EQ(exchange.begin_update(wanted), 0);
    ASSERT_EQ(exchange.update_ghosts({{&c, 1}, {&d, 1}}), 0);
    for (const GhostUpdate &wanted : {GhostUpdate{&b, 3}, GhostUpdate{&a, 3}})
      ASSERT_EQ(exchange.end_update(wanted), 0);
    for (std::ptrdiff_t n = 0; n < domain.layout().size * 3; ++n) b.data()[n] /= 2;
    EXPECT_EQ(count_errors(domain, a, 3), 0);
    EXPECT_EQ(count_errors(domain, b, 3), 0);
    EXPECT_EQ(count_errors(domain, c, 1), 0);
    EXPECT_EQ(count_errors(domain, d, 1), 0);
  });
}

// A block that is at rest but around bodies: away from y's sides no ghost row is touched, nor the ends of rows but of
// those with a body near them.
TEST(GhostExchange, LeavesRestAlone) {
  GridSpec spec;
  spec.cells = {40, 40, 1};
  Domain domain;
  ASSERT_EQ(domain.create(PETSC_COMM_SELF, spec), 0);
  GhostExchange exchange(domain);
  Field phi(domain, 1), block(domain, 2);
  const Layout &own = domain.layout();
  OccupiedRows rows;
  const auto expect_ghosts = [&](int i, int j, bool filled) {
    const Int3 global{(i + 40) % 40, (j + 40) % 40, 0};
    EXPECT_EQ(block[1](i, j, 0), filled ? truth(1, global[0], global[1], 0) : sentinel(own.offset(i, j, 0) + own.size))
        << i << ' ' << j;
  };
  for (const bool inside : {true, false}) {
    phi[0](20, inside ? 12 : 35, 0) = 1;
    phi[0](2, 27, 0) = 1;
    ASSERT_EQ(rows.find(domain, phi[0]), 0);
    ASSERT_EQ(rows.inside(), inside);
    ASSERT_TRUE(rows.idle(2, 0) && !rows.idle(12, 0) && !rows.idle(27, 0));
    prepare(domain, block);
    ASSERT_EQ(exchange.update_ghosts(block, 3, &rows), 0);
    for (const int i : {-3, -1, 40, 42}) {
      expect_ghosts(i, 2, false);
      expect_ghosts(i, 12, false);
      expect_ghosts(i, 27, true);
      expect_ghosts(i, -1, !inside);
    }
    for (const int j : {-3, -1, 40, 42}) expect_ghosts(7, j, !inside);
  }
}

// The exchange belongs to the grid, not to a block: state now and next take turns.
TEST(GhostExchange, CanBeRepeatedAfterSwap) {
  for_each_grid([](const Domain &domain) {
    GhostExchange exchange(domain);
    Field now(domain, 3), next(domain, 3);
    for (int round = 0; round < 3; ++round) {
      prepare(domain, next);
      ASSERT_EQ(exchange.update_ghosts(next, 3), 0);
      now.swap(next);
      EXPECT_EQ(count_errors(domain, now, 3), 0);
    }
  });
}

// Exchange and walls together: each rank's ghosts are, bit for bit, those of the undivided grid.
TEST(WallGhostsOnRanks, EqualThoseOfOneRank) {
  for_each_grid([](const Domain &domain) {
    GridSpec spec = domain.spec();
    spec.processors = {0, 0, 0};
    Domain whole;
    ASSERT_EQ(whole.create(PETSC_COMM_SELF, spec), 0);
    BoundaryConditions walls{};
    for (int d = 0; d < 3; ++d)
      for (int side = 0; side < 2; ++side) walls[d][side].motion = {{.1 + d, .2 + side, .3 - d}, 1.7, .3 * side};
    const int dimension = domain.dimension();
    const int components = static_cast<int>(tensor_components(dimension).size());
    for (const int width : {1, 3}) {
      const auto fill = [&](const Domain &g, Field &velocity, Field &tensor) {
        const Layout &own = g.layout();
        for (Field *block : {&velocity, &tensor}) {
          for (int f = 0; f < block->count(); ++f) block->fill(f, poison);
          for_each_point(own, block->count(), [&](int f, const Int3 &p) {
            if (is_owned(g, p))
              (*block)[f](p[0], p[1], p[2]) =
                  std::sin(truth(f, own.begin[0] + p[0], own.begin[1] + p[1], own.begin[2] + p[2]));
          });
        }
        GhostExchange exchange(g);
        ASSERT_EQ(exchange.update_ghosts(velocity, width), 0);
        ASSERT_EQ(exchange.update_ghosts(tensor, width), 0);
        fill_wall_ghosts_velocity(g, walls, .7, velocity, width);
        fill_wall_ghosts_tensor(g, walls, tensor, width);
      };
      Field velocity(domain, dimension), tensor(domain, components);
      Field whole_velocity(whole, dimension), whole_tensor(whole, components);
      fill(domain, velocity, tensor);
      fill(whole, whole_velocity, whole_tensor);
      int errors = 0, gaps = 0;
      const Layout &own = domain.layout();
      for_each_point(own, components, [&](int f, const Int3 &p) {
        for (int d = 0; d < dimension; ++d)
          if (p[d] < -width || p[d] >= own.cells[d] + width) return;
        Int3 g{};
        for (int d = 0; d < 3; ++d) {
          g[d] = own.begin[d] + p[d];
          if (!domain.is_wall(d)) g[d] = (g[d] + domain.domain_cells()[d]) % domain.domain_cells()[d];
        }
        const auto compare = [&](const Field &part, const Field &all) {
          const double x = part[f](p[0], p[1], p[2]), y = all[f](g[0], g[1], g[2]);
          errors += std::memcmp(&x, &y, sizeof x) != 0;
          gaps += !std::isfinite(x);
        };
        if (f < dimension) compare(velocity, whole_velocity);
        compare(tensor, whole_tensor);
      });
      EXPECT_EQ(errors, 0) << "width " << width;
      EXPECT_EQ(gaps, 0) << "width " << width;
    }
  });
}

}  // namespace
}  // namespace eulastic
