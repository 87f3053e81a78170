// Pieces of ghost rows near what a field has: all ghosts that are near come, and the ranks agree when pieces change.
#include "base/rank_zero.hpp"
#include "field/ghost_exchange.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>

namespace eulastic {
namespace {

constexpr int near = 5;

double truth(int f, const Int3 &g) { return 1 + g[0] + 128 * g[1] + 16384.0 * g[2] + 2097152.0 * f; }

struct Scene {
  Scene(const Int3 &cells, int walls) {
    GridSpec spec;
    spec.cells = cells;
    for (int d = 0; d < 3; ++d) spec.boundary[d] = walls >> d & 1 ? Boundary::wall : Boundary::periodic;
    EXPECT_EQ(grid.create(run_communicator(), spec), 0);
    exchange = std::make_unique<GhostExchange>(grid);
    value = FieldBlock(grid, 1);
  }
  // The value is 1 in these cells alone.
  void set(const std::vector<Int3> &places) {
    const Layout &own = grid.layout();
    value.clear();
    for (const Int3 &p : places) {
      Int3 local;
      bool here = true;
      for (int d = 0; d < 3; ++d) {
        local[d] = p[d] - own.begin[d];
        here = here && local[d] >= 0 && local[d] < own.cells[d];
      }
      if (here) value[0](local[0], local[1], local[2]) = 1;
    }
    ASSERT_EQ(exchange->update(value, grid.spec().ghosts), 0);
    ASSERT_EQ(OccupiedRows::follow(grid, {{&rows, std::as_const(value)[0], near}}), 0);
  }
  Domain grid;
  std::unique_ptr<GhostExchange> exchange;
  FieldBlock value;
  OccupiedRows rows;
};

struct Ghosts {
  long needed = 0, wrong = 0, left = 0;
};

Ghosts bring(Scene &s, int width) {
  constexpr int fields = 2;
  const Layout &own = s.grid.layout();
  FieldBlock block(s.grid, fields);
  std::fill_n(block.data(), own.size * fields, -1.0);
  const auto visit = [&](int layers, const auto &use) {
    for (int f = 0; f < fields; ++f)
      for (int k = -std::min(layers, own.ghosts[2]); k < own.cells[2] + std::min(layers, own.ghosts[2]); ++k)
        for (int j = -layers; j < own.cells[1] + layers; ++j)
          for (int i = -layers; i < own.cells[0] + layers; ++i) {
            Int3 g{own.begin[0] + i, own.begin[1] + j, own.begin[2] + k};
            bool behind = false;
            for (int d = 0; d < 3; ++d) {
              const int n = s.grid.domain_cells()[d];
              if (s.grid.is_wall(d))
                behind = behind || g[d] < 0 || g[d] >= n;
              else
                g[d] = (g[d] % n + n) % n;
            }
            if (!behind) use(f, i, j, k, g);
          }
  };
  visit(0, [&](int f, int i, int j, int k, const Int3 &g) { block[f](i, j, k) = truth(f, g); });
  EXPECT_EQ(s.exchange->update({{&block, width, &s.rows, true, true}}), 0);
  Ghosts found;
  visit(width, [&](int f, int i, int j, int k, const Int3 &g) {
    const double came = block[f](i, j, k);
    bool needed = false;
    for (int z = std::max(k - near, -own.ghosts[2]); z <= std::min(k + near, own.cells[2] + own.ghosts[2] - 1); ++z)
      for (int y = std::max(j - near, -own.ghosts[1]); y <= std::min(j + near, own.cells[1] + own.ghosts[1] - 1); ++y)
        for (int x = std::max(i - near, -own.ghosts[0]); x <= std::min(i + near, own.cells[0] + own.ghosts[0] - 1); ++x)
          needed = needed || s.value[0](x, y, z) != 0;
    found.needed += needed;
    found.wrong += needed && came != truth(f, g);
    found.left += came == -1.0;
  });
  return found;
}

TEST(GhostPieces, HoldAllThatIsNear) {
  for (const Int3 &cells : {Int3{41, 37, 19}, Int3{64, 70, 1}, Int3{600, 20, 1}})
    for (int walls = 0; walls < (cells[2] == 1 ? 4 : 8); ++walls) {
      Scene s(cells, walls);
      s.set({{3, 1, 0}, {cells[0] / 2, cells[1] / 2, cells[2] / 2}, {cells[0] - 1, cells[1] - 1, cells[2] - 1}});
      for (const int width : {3, 4}) {
        SCOPED_TRACE(::testing::Message() << cells[0] << " cells in a row, walls " << walls << ", width " << width);
        const Ghosts found = bring(s, width);
        EXPECT_EQ(found.wrong, 0);
        long sums[2] = {found.needed, found.left};
        MPI_Allreduce(MPI_IN_PLACE, sums, 2, MPI_LONG, MPI_SUM, run_communicator());
        EXPECT_GT(sums[0], 0);
        if (s.rows.near()) {
          EXPECT_GT(sums[1], 0) << "all came";
        }
      }
    }
}

// Of a cell that moves: pieces are the same for two cells, then new ones are there, on all ranks at once.
TEST(GhostPieces, ChangeOnAllRanksAtOnce) {
  Scene s({48, 40, 1}, 0);
  int changes = 0;
  const GhostPieces *before = nullptr;
  for (int step = 0; step < 24; ++step) {
    s.set({{10 + step, 1, 0}});
    int changed[2] = {s.rows.near() != before, s.rows.near() == before};
    MPI_Allreduce(MPI_IN_PLACE, changed, 2, MPI_INT, MPI_MAX, run_communicator());
    EXPECT_NE(changed[0], changed[1]) << "ranks differ";
    changes += changed[0];
    before = s.rows.near();
    EXPECT_EQ(bring(s, 4).wrong, 0) << step;
  }
  if (GhostPieces::exist(s.grid)) {
    EXPECT_GE(changes, 3);
    EXPECT_LE(changes, 9);
  }
}

}  // namespace
}  // namespace eulastic
