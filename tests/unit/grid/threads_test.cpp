// Parts of the rows, and pieces of work, that threads share.
#include "grid/threads.hpp"
#include "base/events.hpp"
#include "bodies/body_sums.hpp"
#include "grid/sum_row_parts.hpp"

#include <gtest/gtest.h>

#include <map>

using namespace eulastic;

namespace {

struct Threads : testing::Test {
  ~Threads() override { set_threads(1); }
};

Domain make_grid(const Int3 &cells) {
  Domain domain;
  GridSpec spec;
  spec.cells = cells;
  EXPECT_EQ(domain.create(PETSC_COMM_SELF, spec), 0);
  return domain;
}

using Rows = std::map<std::pair<int, int>, int>;  // number of times that row (j, k) occurs

void count_rows(const RowPart &part, Rows *rows) {
  for (int k = part.k_begin; k < part.k_end; ++k)
    for (int j = part.j_begin; j < part.j_end; ++j) ++(*rows)[{j, k}];
}

Rows each_once(int j_begin, int j_end, int k_begin, int k_end) {
  Rows rows;
  count_rows({0, j_begin, j_end, k_begin, k_end, true, true}, &rows);
  return rows;
}

}  // namespace

TEST_F(Threads, PartsHoldEveryRowOnce) {
  for (const Int3 &cells : {Int3{128, 33, 1}, Int3{32, 7, 19}, Int3{512, 8, 3}})
    for (const int count : {1, 2, 3, 7}) {
      set_threads(count);
      const Domain domain = make_grid(cells);
      const int parts = row_parts(domain), flat = cells[2] == 1;
      EXPECT_EQ(parts, std::min(count, flat ? count : cells[2])) << cells[0];
      Rows owned, wide;
      for (int p = 0; p < parts; ++p) {
        const RowPart part = row_part(domain, p, parts);
        EXPECT_EQ(part.number, p);
        EXPECT_EQ(part.rows(domain).size(), std::size_t(part.j_end - part.j_begin) * (part.k_end - part.k_begin));
        count_rows(part, &owned);
        count_rows(part.with_ghosts(domain), &wide);
      }
      EXPECT_EQ(owned, each_once(0, cells[1], 0, cells[2]));
      EXPECT_EQ(wide, each_once(-1, cells[1] + 1, flat ? 0 : -1, cells[2] + (flat ? 0 : 1)));
    }
}

TEST_F(Threads, SmallGridsAreNotShared) {
  set_threads(8);
  EXPECT_EQ(row_parts(make_grid({16, 16, 1})), 1);
  EXPECT_EQ(row_parts(make_grid({32, 32, 1})), 2);
}

TEST_F(Threads, PiecesHoldEverythingOnce) {
  for (const std::size_t count : {0, 1, 5, 1000})
    for (const int parts : {1, 3, 8}) {
      std::size_t end = 0;
      for (int p = 0; p < parts; ++p) {
        const Piece piece(count, p, parts);
        EXPECT_EQ(piece.begin, end);
        EXPECT_LE(piece.end - piece.begin, count / parts + 1);
        end = piece.end;
      }
      EXPECT_EQ(end, count);
    }
}

TEST_F(Threads, SumsOfPartsAreThoseOfTheWhole) {
  set_threads(5);
  const Domain domain = make_grid({24, 11, 17});
  const auto value = [](const Segment &row, int s) { return std::ldexp(1.0 + 0.1 * row.j, 9 * row.k - 60 * s) / 3; };
  double whole[2], parts[2];
  ExactSums sums(2);
  BodySums bodies(3, 2), some(3, 2), others(3, 2);
  for (const Segment &row : domain.rows())
    for (int s = 0; s < 2; ++s) {
      sums.add(s, value(row, s));
      const double term = 0.1 * row.j - 0.03 * row.k;
      bodies.add(row.j % 3, s, term);
      (row.k < 5 ? some : others).add(row.j % 3, s, term);
    }
  ASSERT_EQ(sums.reduce(PETSC_COMM_SELF, whole), 0);
  const auto add = [&](const RowPart &part, ExactSums &of_part) {
    for (const Segment &row : part.rows(domain))
      for (int s = 0; s < 2; ++s) of_part.add(s, value(row, s));
  };
  ASSERT_GT(row_parts(domain), 1);
  ASSERT_EQ(sum_row_parts(domain, 2, add, parts), 0);
  some.add(others);
  for (int s = 0; s < 2; ++s) {
    EXPECT_EQ(parts[s], whole[s]);
    for (int b = 0; b < 3; ++b) EXPECT_EQ(some.value(b, s), bodies.value(b, s));
  }
}

TEST_F(Threads, ATeamDoesEveryTaskWhole) {
  set_threads(3);
  std::vector<std::atomic<int>> done(50);
  std::atomic<int> members{0};
  const Domain domain = make_grid({32, 32, 32});
  EXPECT_GT(row_parts(domain), 1);
  const double flops = in_parallel_tasks(50, [&](int n) {
    ++done[n];
    members |= 1 << TeamMember::number();
    EventScope(Event::bodies).flops(n);
    EXPECT_EQ(row_parts(domain), 1);
    in_parallel(3, 3, [&](int) { EXPECT_TRUE(TeamMember::is_here()); });
  });
  EXPECT_EQ(flops, 49 * 50 / 2);
  EXPECT_LT(members, 1 << 3);
  EXPECT_FALSE(TeamMember::is_here());
  for (const std::atomic<int> &times : done) EXPECT_EQ(times, 1);
}
