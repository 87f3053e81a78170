// Global sums and the state hash: the same bits on every decomposition as on one rank.
#include "base/exact_sum.hpp"
#include "base/rank_zero.hpp"
#include "diagnostics/state_hash.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <functional>
#include <random>

namespace eulastic {
namespace {

// Any value from the global index: sixteen bits of exponent spread and both signs.
double value(int field, int i, int j, int k) {
  std::uint64_t x = ((field * 64ull + k) * 64 + j) * 4096 + i;
  for (int n = 0; n < 3; ++n) x = (x ^ (x >> 29)) * 0xbf58476d1ce4e5b9u + 12345;
  const double mantissa = 1 + std::ldexp(static_cast<double>(x >> 12), -52);
  return std::ldexp(x & 1 ? mantissa : -mantissa, static_cast<int>(x >> 1 & 63) - 32);
}

GridSpec box(const Int3 &cells, int walls = 0, const Int3 &processors = {0, 0, 0}) {
  GridSpec spec;
  spec.cells = cells;
  spec.processors = processors;
  for (int d = 0; d < 3; ++d) spec.boundary[d] = walls >> d & 1 ? Boundary::wall : Boundary::periodic;
  return spec;
}

// All decompositions of `cells` over the world that fit.
void for_each_split(const Int3 &cells, int walls, const std::function<void(const Domain &)> &visit) {
  int ranks = 0;
  MPI_Comm_size(run_communicator(), &ranks);
  for (int px = 1; px <= ranks; ++px)
    for (int py = 1; py <= ranks; ++py) {
      const GridSpec spec = box(cells, walls, {px, py, 0});
      if (!Domain::refusal_reason(spec, ranks).empty()) continue;
      Domain domain;
      ASSERT_EQ(domain.create(run_communicator(), spec), 0);
      SCOPED_TRACE(::testing::Message() << cells[0] << " x " << cells[1] << " x " << cells[2] << " on "
                                        << domain.processors(0) << " x " << domain.processors(1) << " x "
                                        << domain.processors(2) << ", walls " << walls);
      visit(domain);
    }
}

// Owned points of a field of this staggering, the high wall included; the rest is NaN.
Field fields_on(const Domain &domain, const std::array<bool, 3> &staggering, int count) {
  Field block(domain, count);
  const Int3 &begin = domain.layout().begin;
  for (int f = 0; f < count; ++f) {
    block.fill(f, std::nan(""));
    for (int k = 0; k < domain.points_end(2, staggering[2]); ++k)
      for (int j = 0; j < domain.points_end(1, staggering[1]); ++j)
        for (int i = 0; i < domain.points_end(0, staggering[0]); ++i)
          block[f](i, j, k) = value(f, begin[0] + i, begin[1] + j, begin[2] + k);
  }
  return block;
}

std::array<double, 3> sums_on(const Domain &domain, std::uint64_t seed) {
  const Field block = fields_on(domain, {}, 3);
  std::vector<Segment> rows = domain.rows();
  std::shuffle(rows.begin(), rows.end(), std::mt19937_64(seed + domain.rank()));
  ExactSums sums(3);
  for (const Segment &row : rows)
    for (int s = 0; s < 3; ++s)
      sums.add_row(s, block[s].row(row.j, row.k), row.size(), domain.layout().begin[0] + row.i_begin);
  std::array<double, 3> result{};
  EXPECT_EQ(sums.reduce(domain.comm(), result.data()), 0);
  return result;
}

TEST(GlobalSums, SameBitsOnAnyRanksInAnyOrder) {
  for (const Int3 &cells : {Int3{13, 10, 11}, Int3{5, 9, 7}, Int3{17, 12, 1}, Int3{300, 12, 1}, Int3{1030, 12, 3}}) {
    Domain whole;
    ASSERT_EQ(whole.create(PETSC_COMM_SELF, box(cells)), 0);
    const std::array<double, 3> expected = sums_on(whole, 0);
    EXPECT_NE(expected[0], expected[1]);
    for_each_split(cells, 0, [&](const Domain &domain) {
      // x is split between blocks where there are enough of them, else its sums are another rounding.
      if (domain.processors(0) > 1 && cells[0] < 256 * domain.processors(0)) return;
      for (const std::uint64_t seed : {1, 7}) {
        const std::array<double, 3> result = sums_on(domain, seed);
        EXPECT_EQ(std::memcmp(result.data(), expected.data(), sizeof expected), 0);
      }
    });
  }
}

TEST(GlobalSums, CancellationAcrossRanks) {
  int rank = 0, ranks = 0;
  MPI_Comm_rank(run_communicator(), &rank);
  MPI_Comm_size(run_communicator(), &ranks);
  ExactSums sums(2);
  sums.add(0, 1e300);
  sums.add(0, 1);
  if (rank == 0)
    for (int n = 0; n < ranks; ++n) sums.add(0, -1e300);
  sums.add(1, rank == ranks - 1 ? std::nan("") : 1);
  double result[2];
  ASSERT_EQ(sums.reduce(run_communicator(), result), 0);
  EXPECT_EQ(result[0], ranks);
  EXPECT_TRUE(std::isnan(result[1]));
}

TEST(GlobalSums, ReduceStartsAnew) {
  int ranks = 0;
  MPI_Comm_size(run_communicator(), &ranks);
  ExactSums sums(1);
  double result = 0;
  for (int round = 0; round < 3; ++round) {
    sums.add(0, 1.5);
    ASSERT_EQ(sums.reduce(run_communicator(), &result), 0);
    EXPECT_EQ(result, 1.5 * ranks);
  }
}

std::uint64_t global_hash(const Domain &domain, const Field &block, const std::array<bool, 3> &staggering,
                          std::uint64_t salt = 3) {
  std::uint64_t hash = hash_points(domain, block[0], staggering, salt);
  MPI_Allreduce(MPI_IN_PLACE, &hash, 1, MPI_UINT64_T, MPI_SUM, domain.comm());
  return hash;
}

TEST(StateHash, SameOnAnyRanksForEveryStaggeringAndBoundary) {
  for (const Int3 &cells : {Int3{13, 10, 11}, Int3{5, 9, 7}, Int3{17, 12, 1}})
    for (int walls = 0; walls < (cells[2] == 1 ? 4 : 8); ++walls)
      for (int s = 0; s < 8; ++s) {
        const std::array<bool, 3> staggering{bool(s & 1), bool(s & 2), bool(s & 4)};
        Domain whole;
        ASSERT_EQ(whole.create(PETSC_COMM_SELF, box(cells, walls)), 0);
        const std::uint64_t expected = global_hash(whole, fields_on(whole, staggering, 1), staggering);
        for_each_split(cells, walls, [&](const Domain &domain) {
          EXPECT_EQ(global_hash(domain, fields_on(domain, staggering, 1), staggering), expected);
        });
      }
}

// Visits the points this rank has of a field of this staggering, as local indices.
template <class Visit>
int for_each_point(const Domain &domain, const std::array<bool, 3> &staggering, const Visit &visit) {
  int points = 0;
  for (int k = 0; k < domain.points_end(2, staggering[2]); ++k)
    for (int j = 0; j < domain.points_end(1, staggering[1]); ++j)
      for (int i = 0; i < domain.points_end(0, staggering[0]); ++i, ++points) visit(i, j, k);
  return points;
}

constexpr std::array<bool, 3> on_z_edges{true, true, false};

// The global hash is a sum over ranks, so that a change on one rank is a change of the whole.
TEST(StateHash, SeesEveryBitOfEveryPointAndNothingElse) {
  for_each_split({5, 9, 7}, 7, [&](const Domain &domain) {
    Field block = fields_on(domain, on_z_edges, 1);
    const View q = block[0];
    const std::uint64_t before = hash_points(domain, q, on_z_edges, 3);
    EXPECT_NE(hash_points(domain, q, on_z_edges, 4), before);
    int unseen = 0;
    int points = for_each_point(domain, on_z_edges, [&](int i, int j, int k) {
      for (int bit = 0; bit < 64; ++bit) {
        const double kept = q(i, j, k);
        std::uint64_t word;
        std::memcpy(&word, &kept, sizeof word);
        word ^= 1ull << bit;
        std::memcpy(&q(i, j, k), &word, sizeof word);
        unseen += hash_points(domain, q, on_z_edges, 3) == before;
        q(i, j, k) = kept;
      }
    });
    EXPECT_EQ(unseen, 0);
    EXPECT_EQ(hash_points(domain, q, on_z_edges, 3), before);
    MPI_Allreduce(MPI_IN_PLACE, &points, 1, MPI_INT, MPI_SUM, domain.comm());
    EXPECT_EQ(points, 6 * 10 * 7);  // the wall planes once

    Field other(domain, 1);  // the same points, other ghosts and padding
    for_each_point(domain, on_z_edges, [&](int i, int j, int k) { other[0](i, j, k) = q(i, j, k); });
    EXPECT_EQ(hash_points(domain, other[0], on_z_edges, 3), before);
  });
}

// Two points that exchange their values, wherever they live.
TEST(StateHash, SeesASwap) {
  for_each_split({5, 9, 7}, 7, [&](const Domain &domain) {
    Field block = fields_on(domain, on_z_edges, 1);
    const Int3 &begin = domain.layout().begin;
    const std::uint64_t before = global_hash(domain, block, on_z_edges);
    const auto set = [&](const Int3 &at, const Int3 &from) {
      const Int3 p{at[0] - begin[0], at[1] - begin[1], at[2] - begin[2]};
      for (int d = 0; d < 3; ++d)
        if (p[d] < 0 || p[d] >= domain.points_end(d, on_z_edges[d])) return;
      block[0](p[0], p[1], p[2]) = value(0, from[0], from[1], from[2]);
    };
    std::mt19937 random(9);
    const auto point = [&] { return Int3{int(random() % 6), int(random() % 10), int(random() % 7)}; };
    for (int n = 0; n < 100; ++n) {
      const Int3 a = point(), b = point();
      if (a == b) continue;
      set(a, b);
      set(b, a);
      EXPECT_NE(global_hash(domain, block, on_z_edges), before);
      set(a, a);
      set(b, b);
    }
    EXPECT_EQ(global_hash(domain, block, on_z_edges), before);
  });
}

}  // namespace
}  // namespace eulastic
