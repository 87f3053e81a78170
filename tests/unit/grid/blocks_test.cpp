// Stages that share a pass over memory: the rows that they process, and that no stage reads a value before it is
// written or overwrites one that is still needed.
#include "grid/blocks.hpp"
#include "grid/domain.hpp"

#include <gtest/gtest.h>

#include <atomic>

using namespace eulastic;

namespace {

// Two fields of rows that hold the number of the stage that wrote them last. The first stage reads field 0 and writes
// field 1; initially field 0 is -1 and field 1 is -2 everywhere.
class Pass {
public:
  Pass(const Domain &domain, int depth, int layers) : domain_(domain), sides_(domain), depth_(depth), layers_(layers) {
    const Int3 &n = domain.cells();
    width_ = n[1] + 2 * margin;
    for (int f = 0; f < 2; ++f) stage_[f].assign(std::size_t(width_) * (n[2] + 2 * margin), -1 - f);
  }

  void run() {
    const StagePass pass(domain_, sides_, depth_, 1, layers_);
    pass.for_tasks([&](const StagePass::Task &task) {
      const auto rows = [&](int s, Segment row, int j_end) {
        EXPECT_EQ(row.size(), domain_.cells()[0]);  // x is periodic
        for (; row.j < j_end; ++row.j) do_row(s, row.j, row.k);
      };
      domain_.dimension() == 2 ? pass.for_rows<2>(task, rows) : pass.for_rows<3>(task, rows);
    });
  }

  // Checks that every stage has processed its rows, including layers, exactly once.
  void expect_complete() const {
    long rows = 0;
    for (int s = 0; s < depth_; ++s)
      rows += long(end(1, s) - begin(1, s)) * (domain_.dimension() == 2 ? 1 : end(2, s) - begin(2, s));
    EXPECT_EQ(rows_, rows);
    const bool flat = domain_.dimension() == 2;
    for (int k = flat ? 0 : begin(2, depth_ - 1); k < (flat ? 1 : end(2, depth_ - 1)); ++k)
      for (int j = begin(1, depth_ - 1); j < end(1, depth_ - 1); ++j)
        EXPECT_EQ(stage_[depth_ % 2][at(j, k)], depth_ - 1);
  }

private:
  static constexpr int margin = 5;

  int begin(int d, int s) const { return -sides_.low(d, depth_ - 1 - s + layers_); }
  int end(int d, int s) const { return domain_.cells()[d] + sides_.high(d, depth_ - 1 - s + layers_); }
  std::size_t at(int j, int k) const { return j + margin + std::size_t(width_) * (k + margin); }

  void do_row(int s, int j, int k) {
    const auto &read = stage_[s % 2];
    auto &write = stage_[1 - s % 2];
    const bool flat = domain_.dimension() == 2;
    for (const auto &[y, z] : {std::pair{0, 0}, {-1, 0}, {1, 0}, {0, flat ? 0 : -1}, {0, flat ? 0 : 1}}) {
      const int row = j + y, plane = k + z;
      const bool behind_wall =
          row < -(sides_.wall[1][0] ? 0 : margin) || row >= domain_.cells()[1] + (sides_.wall[1][1] ? 0 : margin) ||
          plane < -(sides_.wall[2][0] ? 0 : margin) || plane >= domain_.cells()[2] + (sides_.wall[2][1] ? 0 : margin);
      if (behind_wall) continue;
      EXPECT_EQ(read[at(row, plane)], s - 1) << "stage " << s << " reads " << row << " " << plane;
    }
    EXPECT_EQ(write[at(j, k)], s - 2) << "stage " << s << " writes " << j << " " << k;
    write[at(j, k)] = s;
    ++rows_;
  }

  const Domain &domain_;
  HaloOverlap sides_;
  int depth_, layers_, width_ = 0;
  std::vector<int> stage_[2];
  std::atomic<long> rows_{0};
};

}  // namespace

// The row ahead is always a row of the block and, in blocks that are large enough, the one that is processed
// RowAhead::rows rows later.
TEST(Blocks, RowsAheadAreThoseOfTheBlock) {
  for (int rows = 1; rows <= 2 * RowAhead::rows + 3; ++rows) {
    const int begin = 5, end = begin + rows;
    for (int j = begin; j < end; ++j) {
      const RowAhead next(begin, end, j, 7);
      EXPECT_GE(next.j, begin);
      EXPECT_LT(next.j, end);
      if (rows < RowAhead::rows) continue;
      EXPECT_EQ(next.j + rows * (next.k - 7), j + RowAhead::rows) << rows;
    }
  }
}

TEST(StagePass, StagesReadWhatTheOneBeforeHasWritten) {
  for (const Int3 &cells : {Int3{512, 50, 1}, Int3{64, 70, 37}, Int3{64, 31, 16}})
    for (const Boundary y : {Boundary::periodic, Boundary::wall})
      for (const Boundary z : {Boundary::periodic, Boundary::wall})
        for (const auto &[depth, layers] : {std::pair{1, 0}, {2, 0}, {3, 0}, {4, 0}, {2, -1}, {4, -1}})
          for (const int team : {1, 2, 3, 5}) {
            GridSpec spec;
            spec.cells = cells;
            spec.boundary = {Boundary::periodic, y, z};
            Domain domain;
            ASSERT_EQ(domain.create(PETSC_COMM_SELF, spec), 0);
            set_threads(team);
            Pass pass(domain, depth, layers);
            pass.run();
            set_threads(1);
            pass.expect_complete();
            if (testing::Test::HasFailure())
              FAIL() << cells[1] << " rows, " << depth << " stages, " << team << " threads";
          }
}
