// The output directory: refused, emptied, locked.
#include "io/run_directory.hpp"
#include "support/files.hpp"

#include <sys/wait.h>

namespace eulastic {
namespace {

using namespace test;

void put(const std::string &path, const std::string &text) { std::ofstream(path) << text; }

using Earlier = RunDirectory::Earlier;

std::string refusal_of(RunDirectory &run, const std::string &path, bool overwrite) {
  std::string refusal;
  EXPECT_EQ(run.open(PETSC_COMM_SELF, path, overwrite ? Earlier::replaced : Earlier::refused, &refusal), 0);
  EXPECT_EQ(refusal.find('\n'), std::string::npos);
  return refusal;
}

TEST(RunDirectory, IsMadeWithItsParents) {
  const TemporaryDirectory base;
  RunDirectory run;
  EXPECT_EQ(refusal_of(run, base / "a/b/c", false), "");
  EXPECT_TRUE(fs::is_directory(base / "a/b/c"));
  EXPECT_EQ(run.file("series.csv"), base / "a/b/c/series.csv");
}

TEST(RunDirectory, AnEarlierRunIsRefused) {
  const TemporaryDirectory base;
  fs::create_directory(base / "run");
  put(base / "run/summary.json", "{}");
  RunDirectory run;
  const std::string refusal = refusal_of(run, base / "run", false);
  EXPECT_NE(refusal.find("run: is not empty"), std::string::npos) << refusal;
  EXPECT_NE(refusal.find("-output_overwrite"), std::string::npos);
  EXPECT_EQ(text_of(base / "run/summary.json"), "{}");
  EXPECT_FALSE(fs::exists(base / "run/.lock")) << "nothing is written into a refused directory";
}

TEST(RunDirectory, OverwriteTakesOnlyWhatIsOurs) {
  const TemporaryDirectory base;
  fs::create_directory(base / "run");
  const char *const ours[] = {
      "options.txt",         "series.csv",    "summary.json",           "bodies.h5",
      "snapshots.xdmf",      "bodies.h5.tmp", "snapshot_000012.h5",     "checkpoint_000001.h5",
      "summary.json.tmp",    "walls.xdmf",    "snapshot_000012.vtkhdf", "snapshots.vtkhdf.series",
      "snapshot_000012.vti", "snapshots.pvd"};
  const char *const theirs[] = {"notes.txt", "snapshot_000012.h5.old", "my_snapshot_000012.h5", "snapshot_.h5",
                                "optionsXtxt"};
  for (const char *name : ours) put(base / ("run/" + std::string(name)), "x");
  for (const char *name : theirs) put(base / ("run/" + std::string(name)), "x");
  {
    RunDirectory refused;
    EXPECT_EQ(refusal_of(refused, base / "run", true), "");
    EXPECT_TRUE(refused.pending());
    put(refused.file("options.txt"), "new");
  }
  for (const char *name : ours) EXPECT_EQ(text_of(base / ("run/" + std::string(name))), "x") << name;
  EXPECT_FALSE(fs::exists(base / "run/.new"));
  RunDirectory run;
  EXPECT_EQ(refusal_of(run, base / "run", true), "");
  put(run.file("options.txt"), "new");
  EXPECT_EQ(run.accept(PETSC_COMM_SELF), 0);
  EXPECT_FALSE(run.pending());
  EXPECT_EQ(run.path(), base / "run");
  EXPECT_EQ(text_of(base / "run/options.txt"), "new");
  EXPECT_FALSE(fs::exists(base / "run/.new"));
  for (const char *name : ours) EXPECT_EQ(fs::exists(base / ("run/" + std::string(name))), name == ours[0]) << name;
  for (const char *name : theirs) EXPECT_TRUE(fs::exists(base / ("run/" + std::string(name)))) << name;
}

TEST(RunDirectory, AFileIsNoDirectory) {
  const TemporaryDirectory base;
  put(base / "file", "x");
  RunDirectory run, below;
  EXPECT_NE(refusal_of(run, base / "file", true).find("is not a directory"), std::string::npos);
  EXPECT_NE(refusal_of(below, base / "file/run", true), "");
  EXPECT_EQ(text_of(base / "file"), "x");
}

TEST(RunDirectory, OneRunAtATime) {
  const TemporaryDirectory base;
  RunDirectory second;
  {
    RunDirectory first;
    ASSERT_EQ(refusal_of(first, base / "run", false), "");
    put(base / "run/series.csv", "x");
    EXPECT_NE(refusal_of(second, base / "run", true).find("is in use by another run"), std::string::npos);
    EXPECT_EQ(text_of(base / "run/series.csv"), "x");
  }
  RunDirectory third;
  EXPECT_EQ(refusal_of(third, base / "run", true), "");
}

TEST(RunDirectory, TheLockDiesWithItsProcess) {
  const TemporaryDirectory base;
  const std::string path = base / "run";
  int ready[2];
  ASSERT_EQ(::pipe(ready), 0);
  const pid_t child = ::fork();
  if (child == 0) {  // no MPI here: only the lock itself, as rank 0 takes it
    RunDirectory run;
    std::string refusal;
    (void)run.open(PETSC_COMM_SELF, path, Earlier::refused, &refusal);
    (void)!::write(ready[1], "x", 1);
    for (;;) ::pause();
  }
  char byte;
  ASSERT_EQ(::read(ready[0], &byte, 1), 1);
  RunDirectory locked, unlocked;
  EXPECT_NE(refusal_of(locked, path, true).find("is in use"), std::string::npos);
  ::kill(child, SIGKILL);
  ::waitpid(child, nullptr, 0);
  EXPECT_EQ(refusal_of(unlocked, path, true), "");
  ::close(ready[0]);
  ::close(ready[1]);
}

}  // namespace
}  // namespace eulastic
