// Fields with memory on demand: only pages that are written are allocated.
#include "output/saved_state.hpp"
#include "solver/synchronised_state.hpp"
#include "support/scene.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <numeric>

namespace eulastic {
namespace {

// Returns the bytes of private memory of this process.
double own_memory() {
  std::ifstream status("/proc/self/status");
  for (std::string word; status >> word;)
    if (word == "RssAnon:") return status >> word ? 1024 * std::stod(word) : 0;
  return 0;
}

GridSpec box(int n) {
  GridSpec spec;
  spec.cells = {n, n, n};
  spec.length = {1, 1, 1};
  return spec;
}

double sum(const Field &block) {
  return std::accumulate(block.data(), block.data() + block.count() * block.layout().size, 0.0);
}

constexpr double mega = 1 << 20;

TEST(AtRest, OnesThenZerosGhostsIncluded) {
  for (const int n : {5, 70}) {  // less than a page; more than the file of ones
    Domain domain;
    ASSERT_EQ(domain.create(PETSC_COMM_SELF, box(n)), 0);
    const std::ptrdiff_t size = domain.layout().size;
    for (const int ones : {0, 2, 3}) {
      const Field block = Field::on_demand(domain, 3, ones);
      for (std::ptrdiff_t at = 0; at < 3 * size; ++at) ASSERT_EQ(block.data()[at], at < ones * size) << at;
    }
  }
}

TEST(AtRest, BlocksDoNotShareWhatIsWritten) {
  Domain domain;
  ASSERT_EQ(domain.create(PETSC_COMM_SELF, box(64)), 0);
  Field a = Field::on_demand(domain, 1, 1);
  const Field b = Field::on_demand(domain, 1, 1);
  a[0](3, 4, 5) = 7;
  EXPECT_EQ(a[0](3, 4, 5), 7);
  EXPECT_EQ(b[0](3, 4, 5), 1);
  EXPECT_EQ(sum(a) - sum(b), 6);
}

TEST(AtRest, ReadingAndCopyingTakeNoMemory) {
  Domain domain;
  ASSERT_EQ(domain.create(PETSC_COMM_SELF, box(128)), 0);
  const double before = own_memory();
  Field block = Field::on_demand(domain, 4, 2), copy;
  const double all = double(block.bytes());
  ASSERT_GT(all, 64 * mega);
  EXPECT_EQ(sum(block), 2.0 * domain.layout().size);
  for (int k = 0; k < 128; ++k) block[1](k, 64, k) = 3;
  copy.copy_from(block);
  EXPECT_LT(own_memory() - before, 0.1 * all);
  EXPECT_EQ(sum(copy), 2.0 * domain.layout().size + 2 * 128);
  block[1](5, 64, 5) = 1;  // a page that has its defaults again is not allocated in the copy
  copy.copy_from(block);
  EXPECT_EQ(copy[1](5, 64, 5), 1);
  EXPECT_EQ(copy[1](6, 64, 6), 3);
  copy.allocate_fully();
  EXPECT_EQ(sum(copy), sum(block));
}

// A small ball in a large box, with labels, ghosts, hash, and phases at the time of the output.
void expect_little_memory(MethodKind kind) {
  constexpr int n = 112;
  const SolverSpec spec{method_preset(kind), {}, {}};
  test::Scene scene;
  ASSERT_EQ(scene.create(PETSC_COMM_SELF, box(n), spec), 0);
  Phase phase;
  phase.species = "ball";
  phase.material.shear_modulus = 1;
  phase.empty(scene.domain, true);
  for (int k = 50; k < 58; ++k)
    for (int j = 50; j < 58; ++j)
      for (int i = 50; i < 58; ++i) {
        phase.fraction[0](i, j, k) = phase.label[0](i, j, k) = 1;
        phase.tensor.field[0](i, j, k) = 1.2;
      }
  State &state = scene.solver.state();
  state.phases.push_back(std::move(phase));
  ASSERT_EQ(scene.solver.prepare(), 0);  // also allocates data that all bodies share
  FlowExtremes extremes;
  ASSERT_EQ(scene.solver.measure(&extremes), 0);
  const double before = own_memory(), field = double(scene.domain.layout().size) * sizeof(double);
  for (int step = 0; step < 3; ++step) ASSERT_EQ(scene.solver.step(1e-4), 0);
  const std::vector<Phase> *phases = nullptr;
  ASSERT_EQ(scene.solver.synchronised().phases(&phases), 0);
  std::uint64_t hash = 0;
  ASSERT_EQ(state_hash(&scene.solver, &hash), 0);
  EXPECT_GT((*phases)[0].tensor.field[0](53, 53, 53), 1.1);
  EXPECT_EQ((*phases)[0].tensor.field[0](10, 53, 53), 1);
  EXPECT_LT(own_memory() - before, 2 * field) << "of " << field;
}

TEST(AtRest, StepsOfTheClassicMethodTakeLittle) { expect_little_memory(MethodKind::classic); }
TEST(AtRest, StepsOfTheFastMethodTakeLittle) { expect_little_memory(MethodKind::fast); }

}  // namespace
}  // namespace eulastic
