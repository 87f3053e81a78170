// Bodies of one species that come near get phases of their own: whole, at the right moment, the same on any ranks.
#include "bodies/contact.hpp"
#include "base/rank_zero.hpp"
#include "bodies/fill_phase.hpp"
#include "bodies/near_bodies.hpp"
#include "bodies/near_groups.hpp"
#include "field/sides.hpp"
#include "support/files.hpp"

#include <random>
#include <tuple>

namespace eulastic {

inline bool operator<(const BodyMove &a, const BodyMove &b) {
  return std::tie(a.label, a.from, a.to) < std::tie(b.label, b.from, b.to);
}
inline bool operator==(const BodyMove &a, const BodyMove &b) { return !(a < b) && !(b < a); }

}  // namespace eulastic

using namespace eulastic;
using namespace eulastic::test;

namespace {

// Marked blocks of cells; label b + 1 fills block b.
struct Block {
  Int3 begin, end;
};

// What the ranks know together, each once.
template <class T>
std::vector<T> of_all(MPI_Comm comm, const std::vector<T> &mine) {
  int ranks = 1, count = static_cast<int>(mine.size() * sizeof(T));
  MPI_Comm_size(comm, &ranks);
  std::vector<int> counts(ranks), begins(ranks + 1, 0);
  MPI_Allgather(&count, 1, MPI_INT, counts.data(), 1, MPI_INT, comm);
  for (int r = 0; r < ranks; ++r) begins[r + 1] = begins[r] + counts[r];
  std::vector<T> all(begins[ranks] / sizeof(T));
  MPI_Allgatherv(mine.data(), count, MPI_BYTE, all.data(), counts.data(), begins.data(), MPI_BYTE, comm);
  std::sort(all.begin(), all.end());
  all.erase(std::unique(all.begin(), all.end()), all.end());
  return all;
}

struct Marks {
  Domain domain;
  std::vector<Phase> phases;
  std::string crowded;

  Marks(MPI_Comm comm, const Int3 &cells, bool walls) {
    GridSpec spec;
    spec.cells = cells;
    if (walls) spec.boundary[1] = Boundary::wall;
    EXPECT_EQ(domain.create(comm, spec), 0);
  }
  void add(const std::vector<Block> &blocks) {
    Phase phase;
    SpeciesSpec spec;
    spec.name = "bead";
    EXPECT_EQ(fill_phase(domain, spec, {}, 1, &phase), 0);
    phase.separate = true;
    const Int3 &begin = domain.layout().begin, &n = domain.domain_cells();
    for (const Segment &row : domain.rows())
      for (int i = row.i_begin; i < row.i_end; ++i)
        for (std::size_t b = 0; b < blocks.size(); ++b) {
          const int x[3] = {begin[0] + i, begin[1] + row.j, begin[2] + row.k};
          bool inside = true;
          for (int d = 0; d < 3; ++d) {
            const int from_begin = (x[d] - blocks[b].begin[d] + 2 * n[d]) % n[d];  // blocks may cross a seam
            inside = inside && from_begin < blocks[b].end[d] - blocks[b].begin[d];
          }
          if (!inside) continue;
          phase.fraction[0](i, row.j, row.k) = 0.25 + 0.001 * (x[0] + 100 * (x[1] + 100 * x[2])) / 1e4;
          phase.label[0](i, row.j, row.k) = double(b) + 1;
        }
    const auto &components = tensor_components(domain.dimension());
    for (int c = 0; c < phase.tensor.field.count(); ++c) {
      const Staggering at = components[c].at;
      for (int k = 0; k < domain.points_end(2, at[2]); ++k)
        for (int j = 0; j < domain.points_end(1, at[1]); ++j)
          for (int i = 0; i < domain.points_end(0, at[0]); ++i)
            phase.tensor.field[c](i, j, k) =
                2 + c + 1e-3 * (begin[0] + i) + 1e-5 * (begin[1] + j) + 1e-7 * (begin[2] + k);
    }
    phases.push_back(std::move(phase));
  }
  std::vector<NearBodies> near() {
    GhostExchange exchange(domain);
    EXPECT_EQ(exchange.update_ghosts(phases[0].label, contact_reach), 0);
    EXPECT_EQ(exchange.update_ghosts(phases[0].fraction, contact_reach), 0);
    std::vector<NearBodies> pairs;
    find_near_in_phase(domain, {phases[0].label[0], phases[0].fraction[0]}, 0, contact_reach, &pairs);
    return of_all(domain.comm(), pairs);
  }
  std::vector<BodyMove> separate() {
    GhostExchange exchange(domain);
    Separation result;
    EXPECT_EQ(separate_bodies(domain, exchange, {}, &phases, &result), 0);
    crowded = result.crowded;
    const std::vector<BodyMove> moves = of_all(domain.comm(), result.moves);
    std::set<int> changed;
    for (const BodyMove &move : moves) changed.insert({move.from, move.to});
    EXPECT_EQ(result.changed, changed);
    return moves;
  }
};

bool is_pair(const std::vector<NearBodies> &pairs) { return pairs.size() == 1 && pairs[0] == NearBodies{2, 1, 0}; }

constexpr int r = contact_reach;

// Two cubes `gap` cells from each other along each of the directions `apart`; 0 in the others.
std::vector<NearBodies> near_cubes(MPI_Comm comm, bool flat, const Int3 &corner, const Int3 &apart, bool walls) {
  Marks marks(comm, {27, 26, flat ? 1 : 25}, walls);
  Block one{corner, {}}, two{};
  for (int d = 0; d < 3; ++d) {
    const int size = flat && d == 2 ? 1 : 4;
    one.end[d] = corner[d] + size;
    two.begin[d] = apart[d] > 0 ? one.end[d] - 1 + apart[d] : corner[d];
    two.end[d] = two.begin[d] + size;
  }
  marks.add({one, two});
  return marks.near();
}

}  // namespace

TEST(NearBodies, AreFoundAtTheReachAndNotBeyond) {
  for (const MPI_Comm comm : {run_communicator(), PETSC_COMM_SELF})
    for (const bool flat : {false, true})
      for (const Int3 &corner : {Int3{3, 2, 0}, Int3{20, 3, flat ? 0 : 17}, Int3{11, 10, flat ? 0 : 9}})
        for (const Int3 &way : {Int3{1, 0, 0}, Int3{0, 1, 0}, Int3{1, 1, 0}, Int3{0, 0, 1}, Int3{1, 1, 1}}) {
          if (flat && way[2] > 0) continue;
          const auto apart = [&](int gap) { return Int3{gap * way[0], gap * way[1], gap * way[2]}; };
          EXPECT_TRUE(is_pair(near_cubes(comm, flat, corner, apart(r), false)));
          EXPECT_TRUE(is_pair(near_cubes(comm, flat, corner, apart(1), false)));
          EXPECT_TRUE(near_cubes(comm, flat, corner, apart(r + 1), false).empty());
        }
}

TEST(NearBodies, AcrossSeamsAndNotAcrossWalls) {
  for (const MPI_Comm comm : {run_communicator(), PETSC_COMM_SELF})
    for (const bool walls : {false, true}) {
      Marks marks(comm, {40, 40, 1}, walls);
      marks.add({{{10, 1, 0}, {14, 3, 1}}, {{10, 37, 0}, {14, 39, 1}}});
      EXPECT_EQ(marks.near().size(), walls ? 0u : 1u);
      Marks across(comm, {40, 12, 1}, walls);
      across.add({{{1, 4, 0}, {3, 7, 1}}, {{37, 4, 0}, {39, 7, 1}}});
      EXPECT_TRUE(is_pair(across.near()));
    }
}

TEST(Contact, AMovedBodyKeepsEveryValue) {
  for (const Int3 &cells : {Int3{24, 22, 1}, Int3{18, 20, 19}}) {
    const int z = cells[2];
    const std::vector<Block> blocks{{{4, 4, 0}, {8, 9, z / 2 + 1}}, {{10, 5, 0}, {13, 9, z / 2 + 1}}};
    Marks marks(run_communicator(), cells, true), before(run_communicator(), cells, true);
    marks.add(blocks);
    before.add(blocks);
    const std::vector<BodyMove> moves = marks.separate();
    ASSERT_EQ(moves.size(), 1u);
    EXPECT_EQ(moves[0].label, 2);
    ASSERT_EQ(marks.phases.size(), 2u);
    const Phase &from = marks.phases[0], &to = marks.phases[1], &old = before.phases[0];
    EXPECT_EQ(to.species, "bead");
    EXPECT_EQ(to.colour, 1);
    const Domain &domain = marks.domain;
    for (const Segment &row : domain.rows())
      for (int i = row.i_begin; i < row.i_end; ++i) {
        const double label = old.label[0](i, row.j, row.k), phi = old.fraction[0](i, row.j, row.k);
        ASSERT_EQ(from.label[0](i, row.j, row.k), label == 2 ? 0 : label);
        ASSERT_EQ(to.label[0](i, row.j, row.k), label == 2 ? 2 : 0);
        ASSERT_EQ(from.fraction[0](i, row.j, row.k), label == 2 ? 0 : phi);
        ASSERT_EQ(to.fraction[0](i, row.j, row.k), label == 2 ? phi : 0);
      }
    // B where a cell of the body touches the point; elsewhere it is of nobody.
    const auto &components = tensor_components(domain.dimension());
    const Int3 &begin = domain.layout().begin;
    const Block &body = blocks[1];
    for (int c = 0; c < to.tensor.field.count(); ++c) {
      const Staggering at = components[c].at;
      for (int k = 0; k < domain.points_end(2, at[2]); ++k)
        for (int j = 0; j < domain.points_end(1, at[1]); ++j)
          for (int i = 0; i < domain.points_end(0, at[0]); ++i) {
            const int x[3] = {begin[0] + i, begin[1] + j, begin[2] + k};
            bool touches = true;
            for (int d = 0; d < 3; ++d) {
              const bool next = x[d] >= body.begin[d] && x[d] < body.end[d] + at[d];
              const bool seam = at[d] && !domain.is_wall(d) && x[d] == 0 && body.end[d] == cells[d];
              touches = touches && (next || seam);
            }
            if (touches) {
              ASSERT_EQ(to.tensor.field[c](i, j, k), old.tensor.field[c](i, j, k)) << c;
            } else {
              ASSERT_EQ(to.tensor.field[c](i, j, k), components[c].a == components[c].b ? 1 : 0) << c;
            }
            ASSERT_EQ(from.tensor.field[c](i, j, k), old.tensor.field[c](i, j, k));
          }
    }
    EXPECT_TRUE(marks.separate().empty());
    EXPECT_EQ(marks.phases.size(), 2u);
  }
}

// Remains of one body, phi < 1e-5, reach cells of another in the phase that it goes to: nothing is overwritten.
TEST(Contact, RemainsOfABodyOverwriteNobody) {
  Marks marks(run_communicator(), {40, 20, 1}, true);
  marks.add({{{3, 5, 0}, {7, 9, 1}}, {{9, 5, 0}, {13, 9, 1}}, {{22, 5, 0}, {26, 9, 1}}});
  ASSERT_EQ(marks.separate().size(), 1u);  // bead 2 goes
  const Int3 &begin = marks.domain.layout().begin;
  const auto for_each = [&](auto &&visit) {
    for (const Segment &row : marks.domain.rows())
      for (int i = row.i_begin; i < row.i_end; ++i) visit(begin[0] + i, begin[1] + row.j, i, row.j, row.k);
  };
  // Bead 2 now has a thin tail up to x = 24, over bead 3 in the other phase; bead 1 has come near bead 3: both in phase
  // 0. Then bead 3 has to go to where the tail is.
  constexpr double thin = 1e-8;
  Phase &home = marks.phases[0], &away = marks.phases[1];
  std::vector<double> sum(4, 0.0), first(4, 0.0);
  for_each([&](int x, int y, int i, int j, int k) {
    if (y == 6 && x >= 13 && x < 25) away.fraction[0](i, j, k) = thin, away.label[0](i, j, k) = 2;
    if (y >= 5 && y < 9 && x >= 27 && x < 29) home.fraction[0](i, j, k) = .5, home.label[0](i, j, k) = 1;
  });
  const auto volumes = [&](std::vector<double> *all) {
    for (const Phase &phase : marks.phases)
      for_each(
          [&](int, int, int i, int j, int k) { (*all)[int(phase.label[0](i, j, k))] += phase.fraction[0](i, j, k); });
    MPI_Allreduce(MPI_IN_PLACE, all->data(), 4, MPI_DOUBLE, MPI_SUM, marks.domain.comm());
  };
  volumes(&first);
  const std::vector<BodyMove> moves = marks.separate();
  ASSERT_EQ(moves.size(), 1u);
  EXPECT_EQ(moves[0].label, 3);
  EXPECT_EQ(moves[0].to, 1);
  volumes(&sum);
  for (int b = 1; b < 4; ++b) EXPECT_NEAR(sum[b], first[b], 5 * thin) << b;
  EXPECT_NEAR(sum[1] + sum[2] + sum[3], first[1] + first[2] + first[3], 1e-13);
}

TEST(Contact, LowestFreeColourAndNoMoreThanNeeded) {
  // A chain of five: two colours do. Then a sixth that touches two of either.
  Marks chain(run_communicator(), {60, 24, 1}, true);
  std::vector<Block> blocks;
  for (int b = 0; b < 5; ++b) blocks.push_back({{3 + (2 + r) * b, 3, 0}, {6 + (2 + r) * b, 6, 1}});
  chain.add(blocks);
  EXPECT_FALSE(chain.separate().empty());
  EXPECT_EQ(chain.phases.size(), 2u);
  EXPECT_TRUE(chain.separate().empty());
  Marks third(run_communicator(), {60, 24, 1}, true);
  blocks.push_back({{7, 8, 0}, {13, 11, 1}});
  third.add(blocks);
  EXPECT_GE(third.separate().size(), 3u);
  EXPECT_EQ(third.phases.size(), 3u);
  EXPECT_TRUE(third.separate().empty());
}

TEST(NearGroups, OneRankKnowsAllOfAGroup) {
  int rank, ranks;
  MPI_Comm_rank(run_communicator(), &rank);
  MPI_Comm_size(run_communicator(), &ranks);
  // Rank r sees bodies 10 r + 1 ... 10 r + 11 of which the last is the next rank's; the first half of a chain goes
  // through all ranks, the others are pairs or alone.
  std::vector<int> seen;
  for (int n = 1; n <= 11; ++n) seen.push_back(10 * rank + n);
  std::vector<NearBodies> pairs{{10 * rank + 11, 10 * rank + 1, 0}, {10 * rank + 4, 10 * rank + 3, 1}};
  for (const int n : {2, 11}) pairs.push_back({10 * rank + n, 0, 5});
  NearGroups groups;
  ASSERT_EQ(groups.connect(run_communicator(), seen), 0);
  ASSERT_EQ(groups.gather(&pairs), 0);
  int count = static_cast<int>(pairs.size()), chain = 0;
  for (const NearBodies &pair : pairs) chain += pair.body % 10 == 1;
  EXPECT_TRUE(chain == 0 || chain == 2 * ranks);
  MPI_Allreduce(MPI_IN_PLACE, &count, 1, MPI_INT, MPI_SUM, run_communicator());
  EXPECT_EQ(count, 4 * ranks);
  EXPECT_TRUE(std::is_sorted(pairs.begin(), pairs.end()));
  std::vector<BodyMove> moves;
  for (const NearBodies &pair : pairs)
    if (pair.other == 0) moves.push_back({pair.body, pair.phase, pair.body % 7});
  ASSERT_EQ(groups.spread(&moves), 0);
  std::vector<BodyMove> expected{{10 * rank + 2, 5, (10 * rank + 2) % 7}, {10 * rank + 11, 5, (10 * rank + 11) % 7}};
  if (rank > 0) expected.insert(expected.begin(), {10 * rank + 1, 5, (10 * rank + 1) % 7});
  EXPECT_TRUE(moves == expected);
}

TEST(Contact, AsOnOneRank) {
  std::mt19937 random(1);
  for (const Int3 &cells : {Int3{70, 61, 1}, Int3{33, 29, 26}}) {
    Marks many(run_communicator(), cells, false), one(PETSC_COMM_SELF, cells, false);
    for (int phase = 0; phase < 2; ++phase) {
      std::vector<Block> blocks(phase * 30);  // labels go on
      for (int b = 0; b < 30; ++b) {
        Block block;
        for (int d = 0; d < 3; ++d) {
          block.begin[d] = static_cast<int>(random() % cells[d]);
          block.end[d] = block.begin[d] + (cells[d] == 1 ? 1 : 2);
        }
        blocks.push_back(block);
      }
      many.add(blocks);
      one.add(blocks);
    }
    for (int round = 0; round < 4; ++round) {
      EXPECT_TRUE(many.separate() == one.separate()) << round;
      EXPECT_EQ(many.phases.size(), one.phases.size());
    }
    EXPECT_GT(one.phases.size(), 2u);
  }
}

TEST(Contact, MoreThanTheLimitIsReportedAndNothingMoves) {
  Marks marks(run_communicator(), {12, 12, 1}, true);
  std::vector<Block> blocks;
  for (int b = 0; b < 144; ++b) blocks.push_back({{b % 12, b / 12, 0}, {b % 12 + 1, b / 12 + 1, 1}});
  marks.add(blocks);
  EXPECT_FALSE(marks.separate().empty());
  EXPECT_LE(marks.phases.size(), std::size_t(most_colours));
  // A periodic box in which each is near all others.
  Marks tight(run_communicator(), {6, 6, 12}, false);
  blocks.clear();
  for (int b = 0; b < 144; ++b) blocks.push_back({{b % 6, b / 6 % 6, b / 36}, {b % 6 + 1, b / 6 % 6 + 1, b / 36 + 1}});
  tight.add(blocks);
  EXPECT_TRUE(tight.separate().empty());
  EXPECT_EQ(tight.phases.size(), 1u);
  EXPECT_EQ(tight.crowded.rfind("-bead_contact: more than 64", 0), 0u) << tight.crowded;
}
