// What the machine has, from files as kernels write them; what is refused, with both numbers.
#include "app/memory.hpp"
#include "support/command_line.hpp"
#include "support/files.hpp"

using namespace eulastic;
using namespace eulastic::test;

namespace {

void put(const std::string &path, const std::string &text) {
  fs::create_directories(fs::path(path).parent_path());
  std::ofstream(path) << text;
}

std::string refusal(const std::string &line) {
  const ParseResult parsed = parse_line(line);
  EXPECT_EQ(parsed.error, "");
  std::string text;
  EXPECT_EQ(check_sizes(PETSC_COMM_SELF, parsed.config, &text), 0);
  return text;
}

}  // namespace

TEST(Memory, PhysicalWithoutGroups) {
  const TemporaryDirectory empty;
  EXPECT_EQ(memory_limit(empty / "none"), double(sysconf(_SC_PHYS_PAGES)) * double(sysconf(_SC_PAGESIZE)));
  EXPECT_GT(memory_limit(), 0);
  EXPECT_LE(memory_limit(), memory_limit(empty / "none"));
}

TEST(Memory, TheLeastOfTheGroupsAbove) {
  const TemporaryDirectory root;
  put(root / "proc/self/cgroup", "0::/user.slice/job\n");
  put(root / "sys/fs/cgroup/user.slice/job/memory.max", "max\n");
  EXPECT_EQ(memory_limit(root / ""), memory_limit(root / "none"));
  put(root / "sys/fs/cgroup/user.slice/memory.max", "7000000\n");
  EXPECT_EQ(memory_limit(root / ""), 7000000);
  put(root / "sys/fs/cgroup/user.slice/job/memory.max", "6000000\n");
  EXPECT_EQ(memory_limit(root / ""), 6000000);
}

TEST(Memory, OldGroups) {
  const TemporaryDirectory root;
  put(root / "proc/self/cgroup", "12:cpu,cpuacct:/a\n4:hugetlb,memory:/b/c\nnonsense\n0::/\n");
  put(root / "sys/fs/cgroup/memory/b/memory.limit_in_bytes", "5000000\n");
  put(root / "sys/fs/cgroup/cpu/a/memory.limit_in_bytes", "1\n");
  EXPECT_EQ(memory_limit(root / ""), 5000000);
}

TEST(Memory, RefusedWithBothNumbers) {
  EXPECT_EQ(refusal(scene), "");
  const std::string text = refusal("-time_end 1 -grid_cells 1290,1290,1290");
  EXPECT_NE(text.find("GB on a node (1 ranks), which has"), std::string::npos) << text;
  EXPECT_NE(text.find("-guard_memory"), std::string::npos) << text;
  // A machine with that much memory: PETSc cannot count to 6 x 1296^3.
  const std::string off = refusal("-time_end 1 -grid_cells 1290,1290,1290 -guard_memory 0");
  EXPECT_NE(off.find("a field of 13060694016 numbers"), std::string::npos) << off;
  EXPECT_NE(refusal(scene + " -guard_memory 1e-9").find("1e-09 now"), std::string::npos);
}
