// Files a run leaves behind, as one process writes them: directory, lock, series, summary, bodies; and progress.
#include "base/progress.hpp"
#include "io/bodies_file.hpp"
#include "io/checksum.hpp"
#include "io/hdf5_handle.hpp"
#include "io/json.hpp"
#include "io/run_directory.hpp"
#include "io/series.hpp"
#include "io/summary.hpp"
#include "io/text_file.hpp"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmath>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <limits>
#include <map>
#include <sstream>

namespace eulastic {
namespace {

namespace fs = std::filesystem;

class TemporaryDirectory {
public:
  TemporaryDirectory() {
    std::string name = (fs::temp_directory_path() / "eulastic_io_test_XXXXXX").string();
    path_ = ::mkdtemp(name.data());
  }
  ~TemporaryDirectory() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  std::string operator/(const std::string &name) const { return (path_ / name).string(); }

private:
  fs::path path_;
};

std::string text_of(const std::string &path) {
  std::stringstream text;
  text << std::ifstream(path, std::ios::binary).rdbuf();
  return text.str();
}

void put(const std::string &path, const std::string &text) { std::ofstream(path) << text; }

// No file may grow beyond so many bytes.
class FullDisk {
public:
  explicit FullDisk(rlim_t bytes) : handler_(std::signal(SIGXFSZ, SIG_IGN)) {
    ::getrlimit(RLIMIT_FSIZE, &old_);
    const rlimit limit{bytes, old_.rlim_max};
    ::setrlimit(RLIMIT_FSIZE, &limit);
  }
  ~FullDisk() {
    ::setrlimit(RLIMIT_FSIZE, &old_);
    std::signal(SIGXFSZ, handler_);
  }

private:
  rlimit old_;
  void (*handler_)(int);
};

// The message of a call that must fail, with PETSc's traceback off.
template <class Call>
std::string error_of(Call call) {
  const char *text;
  char *specific = nullptr;
  PetscPushErrorHandler(PetscReturnErrorHandler, nullptr);
  const PetscErrorCode code = call();
  PetscPopErrorHandler();
  if (code == 0) return "no error";
  PetscErrorMessage(code, &text, &specific);
  return specific;
}

std::string refusal_of(RunDirectory &run, const std::string &path, bool overwrite) {
  std::string refusal;
  EXPECT_EQ(run.open(PETSC_COMM_SELF, path, overwrite, &refusal), 0);
  EXPECT_EQ(refusal.find('\n'), std::string::npos);
  return refusal;
}

// ---------------------------------------------------------------------------------------------- directory and lock

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
  const char *const ours[] = {"options.txt",        "series.csv",           "summary.json",
                              "bodies.h5",          "snapshots.xdmf",       "bodies.h5.tmp",
                              "snapshot_000012.h5", "checkpoint_000001.h5", "summary.json.tmp"};
  const char *const theirs[] = {"notes.txt", "snapshot_000012.h5.old", "my_snapshot_000012.h5", "snapshot_.h5",
                                "optionsXtxt"};
  for (const char *name : ours) put(base / ("run/" + std::string(name)), "x");
  for (const char *name : theirs) put(base / ("run/" + std::string(name)), "x");
  RunDirectory run;
  EXPECT_EQ(refusal_of(run, base / "run", true), "");
  for (const char *name : ours) EXPECT_FALSE(fs::exists(base / ("run/" + std::string(name)))) << name;
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
    (void)run.open(PETSC_COMM_SELF, path, false, &refusal);
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

// ------------------------------------------------------------------------------------------------------------ text

TEST(TextFile, ReplacesTheOldOneOrLeavesIt) {
  const TemporaryDirectory base;
  ASSERT_EQ(write_text_file(PETSC_COMM_SELF, base / "a.txt", "old\n"), 0);
  ASSERT_EQ(write_text_file(PETSC_COMM_SELF, base / "a.txt", "new\n"), 0);
  EXPECT_EQ(text_of(base / "a.txt"), "new\n");
  EXPECT_FALSE(fs::exists(base / "a.txt.tmp"));
  std::string error;
  {
    const FullDisk full_disk(4096);
    error = error_of([&] { return write_text_file(PETSC_COMM_SELF, base / "a.txt", std::string(100000, 'x')); });
  }
  EXPECT_NE(error.find("cannot write " + (base / "a.txt")), std::string::npos) << error;
  EXPECT_EQ(text_of(base / "a.txt"), "new\n");
  EXPECT_FALSE(fs::exists(base / "a.txt.tmp"));
  EXPECT_NE(error_of([&] { return write_text_file(PETSC_COMM_SELF, base / "no/a.txt", ""); }), "no error");
}

TEST(FormatDouble, ReadsBackAsItWas) {
  EXPECT_EQ(format_double(0.1), "0.10000000000000001");
  EXPECT_EQ(format_double(12), "12");
  EXPECT_EQ(format_double(-2.5e-300), "-2.5e-300");
  EXPECT_EQ(format_double(std::nan("")), "nan");
  EXPECT_EQ(format_double(-INFINITY), "-inf");
  double x = 1e-300;
  for (int n = 0; n < 2000; ++n, x *= -2.0371) ASSERT_EQ(std::strtod(format_double(x).c_str(), nullptr), x);
}

TEST(Series, RowsAreInTheFileAtOnce) {
  const TemporaryDirectory base;
  const std::string path = base / "series.csv";
  Series series;
  ASSERT_EQ(series.open(PETSC_COMM_SELF, path, {"time", "energy"}), 0);
  EXPECT_EQ(text_of(path), "time,energy\n");
  ASSERT_EQ(series.write({0, 0.1}), 0);
  EXPECT_EQ(text_of(path), "time,energy\n0,0.10000000000000001\n");
  ASSERT_EQ(series.write({1e300, -INFINITY}), 0);
  Series again;  // after a restart
  ASSERT_EQ(again.open(PETSC_COMM_SELF, path, {"time", "energy"}), 0);
  ASSERT_EQ(again.write({2, 3}), 0);
  EXPECT_EQ(text_of(path), "time,energy\n0,0.10000000000000001\n1.0000000000000001e+300,-inf\n2,3\n");
  Series other;
  EXPECT_NE(error_of([&] {
              return other.open(PETSC_COMM_SELF, path, {"time", "work"});
            }).find("other columns"),
            std::string::npos);
  EXPECT_NE(error_of([&] { return again.write({2}); }).find("1 values for 2 columns"), std::string::npos);
  EXPECT_NE(error_of([&] { return other.open(PETSC_COMM_SELF, base / "no/s.csv", {"a"}); }).find("No such file"),
            std::string::npos);
  Series full;
  ASSERT_EQ(full.open(PETSC_COMM_SELF, base / "full.csv", {"a"}), 0);
  const FullDisk full_disk(4);
  EXPECT_NE(error_of([&] { return full.write({12345}); }).find("cannot write"), std::string::npos);
}

// ------------------------------------------------------------------------------------------------------------ json

// Reads JSON strictly: keys with their path ("bodies.0.id") and the text of every value.
class JsonReader {
public:
  explicit JsonReader(const std::string &text) : text_(text) {
    value("");
    space();
    fine_ = fine_ && at_ == text_.size();
  }
  bool fine() const { return fine_; }
  const std::vector<std::string> &keys() const { return keys_; }
  std::string operator[](const std::string &key) const { return values_.count(key) ? values_.at(key) : "missing"; }

private:
  void space() { at_ = std::min(text_.find_first_not_of(" \n", at_), text_.size()); }
  bool take(char c) {
    space();
    if (at_ >= text_.size() || text_[at_] != c) return false;
    ++at_;
    return true;
  }
  std::string string() {
    std::string result;
    if (!take('"')) fine_ = false;
    while (fine_ && at_ < text_.size() && text_[at_] != '"') {
      if (static_cast<unsigned char>(text_[at_]) < 0x20) fine_ = false;
      if (text_[at_] == '\\') result += text_[at_++];
      result += text_[at_++];
    }
    fine_ = fine_ && take('"');
    return result;
  }
  void value(const std::string &path) {
    if (!fine_) return;
    const auto child = [&](const std::string &name) { return path.empty() ? name : path + "." + name; };
    if (take('{')) {
      if (take('}')) return;
      do {
        const std::string key = child(string());
        fine_ = fine_ && take(':');
        keys_.push_back(key);
        value(key);
      } while (fine_ && take(','));
      fine_ = fine_ && take('}');
    } else if (take('[')) {
      if (take(']')) return;
      int n = 0;
      do value(child(std::to_string(n++)));
      while (fine_ && take(','));
      fine_ = fine_ && take(']');
    } else if (space(), at_ < text_.size() && text_[at_] == '"') {
      values_[path] = string();
    } else {
      const std::size_t end = std::min(text_.find_first_of(",]} \n", at_), text_.size());
      const std::string word = text_.substr(at_, end - at_);
      char *rest = nullptr;
      if (word != "null") (void)std::strtod(word.c_str(), &rest);
      fine_ = word == "null" || (!word.empty() && *rest == 0 && word.find_first_not_of("-+.e0123456789") == word.npos);
      values_[path] = word;
      at_ = end;
    }
  }

  std::string text_;
  std::size_t at_ = 0;
  bool fine_ = true;
  std::vector<std::string> keys_;
  std::map<std::string, std::string> values_;
};

TEST(Json, WhatItWritesCanBeRead) {
  const JsonReader json(Json()
                            .add("text", std::string("a \"quoted\" \\ back\nslash"))
                            .add("third", 1.0 / 3)
                            .add("nan", std::nan(""))
                            .add("vector", Real3{1, -INFINITY, 1e-7})
                            .add("none", std::vector<Json>{})
                            .add("list", std::vector<Json>{Json().add("n", 1L), Json().add("n", -2L), Json()})
                            .text());
  EXPECT_TRUE(json.fine());
  EXPECT_EQ(json["text"], "a \\\"quoted\\\" \\\\ back\\u000aslash");
  EXPECT_EQ(json["third"], "0.33333333333333331");
  EXPECT_EQ(json["nan"], "null");
  EXPECT_EQ(json["vector.1"], "null");
  EXPECT_EQ(json["vector.2"], "9.9999999999999995e-08");
  EXPECT_EQ(json["list.1.n"], "-2");
  for (const char *broken : {"{", "{\"a\": nan}", "{\"a\": 1,}", "{\"a\" 1}", "{\"a\": 1}}", "{\"a\": [1 2]}"})
    EXPECT_FALSE(JsonReader(broken).fine()) << broken;
}

TEST(Summary, HasEveryKey) {
  const TemporaryDirectory base;
  Summary summary;
  summary.method = "classic";
  summary.cells = 4096;
  summary.steps = 10;
  summary.wall_seconds = 2;
  summary.state_hash = 0xfedcba9876543210u;
  summary.divergence_max = std::nan("");
  summary.bodies = {{1, "rbc", {1, 2, 3}, {4, 5, 6}, 7, 0.5, -45}, {2, "rbc", {}, {}, 0, 0, 0}};
  ASSERT_EQ(write_summary(PETSC_COMM_SELF, base / "summary.json", summary), 0);
  const JsonReader json(text_of(base / "summary.json"));
  ASSERT_TRUE(json.fine());
  const std::vector<std::string> expected{"version",
                                          "method",
                                          "pressure_solver",
                                          "exit_reason",
                                          "cells",
                                          "ranks",
                                          "threads",
                                          "steps",
                                          "time",
                                          "dt_mean",
                                          "wall_seconds",
                                          "wall_seconds_total",
                                          "cell_updates_per_second",
                                          "ns_per_cell_step",
                                          "bytes_per_cell",
                                          "active_fraction",
                                          "acm_sweeps_per_step",
                                          "rkl_stages_per_step",
                                          "divergence_rms",
                                          "divergence_max",
                                          "mach_max",
                                          "volume_drift",
                                          "kinetic_energy",
                                          "elastic_energy",
                                          "bulk_velocity",
                                          "state_hash",
                                          "bodies",
                                          "bodies.0.id",
                                          "bodies.0.species",
                                          "bodies.0.centroid",
                                          "bodies.0.velocity",
                                          "bodies.0.volume",
                                          "bodies.0.taylor_deformation",
                                          "bodies.0.inclination"};
  ASSERT_GE(json.keys().size(), expected.size());
  for (std::size_t n = 0; n < expected.size(); ++n) EXPECT_EQ(json.keys()[n], expected[n]);
  EXPECT_EQ(json["cell_updates_per_second"], "20480");
  EXPECT_EQ(json["ns_per_cell_step"], format_double(2e9 / 40960));
  EXPECT_EQ(json["state_hash"], "fedcba9876543210");
  EXPECT_EQ(json["divergence_max"], "null");
  EXPECT_EQ(json["bodies.0.centroid.2"], "3");
  EXPECT_EQ(json["bodies.1.id"], "2");
  const JsonReader nothing(summary_text({}));  // no steps: rates are 0/0
  EXPECT_TRUE(nothing.fine());
  EXPECT_EQ(nothing["ns_per_cell_step"], "null");
}

// ---------------------------------------------------------------------------------------------------------- bodies

struct BodyTable {
  explicit BodyTable(const std::string &path) : file(H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT)) {}
  std::vector<double> read(const std::string &name, std::vector<hsize_t> *shape) const {
    const Hdf5Dataset dataset(H5Dopen2(file.get(), name.c_str(), H5P_DEFAULT));
    *shape = hdf5_shape(dataset.get());
    std::size_t count = 1;
    for (const hsize_t n : *shape) count *= n;
    std::vector<double> values(count);
    EXPECT_GE(H5Dread(dataset.get(), H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()), 0);
    const Hdf5Attribute attribute(H5Aopen(dataset.get(), "checksum", H5P_DEFAULT));
    std::string sum(16, ' ');
    EXPECT_GE(H5Aread(attribute.get(), hdf5_string(16).get(), sum.data()), 0);
    if (name != "id") {
      EXPECT_EQ(sum, checksum_text(checksum(values.data(), count, 0))) << name;
    }
    return values;
  }
  hsize_t rows() const {
    std::vector<hsize_t> shape;
    (void)read("time", &shape);
    return shape[0];
  }
  Hdf5FileHandle file;
};

std::vector<BodyRecord> bodies_at(int row) {
  std::vector<BodyRecord> bodies(3);
  for (int b = 0; b < 3; ++b) {
    const double x = 100 * row + 10 * b;
    bodies[b] = {b + 1, b < 2 ? "rbc" : "platelet", {x, x + 1, x + 2}, {x + 3, x + 4, x + 5}, x + 6, x + 7, x + 8};
  }
  return bodies;
}

TEST(BodiesFile, GrowsAndIsReadableAllTheTime) {
  const TemporaryDirectory base;
  const std::string path = base / "bodies.h5";
  BodiesFile file(PETSC_COMM_SELF, path);
  constexpr int rows = 100;
  for (int n = 0; n < rows; ++n) {
    ASSERT_EQ(file.add(0.5 * n, bodies_at(n)), 0);
    EXPECT_FALSE(fs::exists(path + ".tmp"));
    const BodyTable table(path);
    ASSERT_TRUE(bool(table.file));
    EXPECT_GE(5 * table.rows(), hsize_t(4 * (n + 1))) << "a kill loses at most a fifth";
  }
  EXPECT_LT(BodyTable(path).rows(), hsize_t(rows)) << "rows wait, or the cost would be quadratic";
  ASSERT_EQ(file.flush(), 0);
  const BodyTable table(path);
  std::vector<hsize_t> shape;
  EXPECT_EQ(table.read("id", &shape), (std::vector<double>{1, 2, 3}));
  const std::vector<double> time = table.read("time", &shape);
  ASSERT_EQ(shape, (std::vector<hsize_t>{rows}));
  const std::vector<double> centroid = table.read("centroid", &shape);
  ASSERT_EQ(shape, (std::vector<hsize_t>{rows, 3, 3}));
  const std::vector<double> velocity = table.read("velocity", &shape);
  const char *const scalars[] = {"volume", "taylor_deformation", "inclination"};
  for (int n = 0; n < rows; ++n) {
    EXPECT_EQ(time[n], 0.5 * n);
    for (int b = 0; b < 3; ++b)
      for (int d = 0; d < 3; ++d) {
        EXPECT_EQ(centroid[(n * 3 + b) * 3 + d], 100 * n + 10 * b + d);
        EXPECT_EQ(velocity[(n * 3 + b) * 3 + d], 100 * n + 10 * b + d + 3);
      }
  }
  for (int s = 0; s < 3; ++s) {
    const std::vector<double> values = table.read(scalars[s], &shape);
    ASSERT_EQ(shape, (std::vector<hsize_t>{rows, 3}));
    for (int n = 0; n < rows; ++n)
      for (int b = 0; b < 3; ++b) EXPECT_EQ(values[n * 3 + b], 100 * n + 10 * b + 6 + s);
  }
  const Hdf5Dataset species(H5Dopen2(table.file.get(), "species", H5P_DEFAULT));
  char names[24];
  ASSERT_GE(H5Dread(species.get(), hdf5_string(8).get(), H5S_ALL, H5S_ALL, H5P_DEFAULT, names), 0);
  EXPECT_EQ(std::string(names, 8), std::string("rbc\0\0\0\0\0", 8));
  EXPECT_EQ(std::string(names + 16, 8), "platelet");
}

TEST(BodiesFile, SaysWhatIsWrong) {
  const TemporaryDirectory base;
  BodiesFile nowhere(PETSC_COMM_SELF, base / "no/bodies.h5"), changing(PETSC_COMM_SELF, base / "bodies.h5"),
      empty(PETSC_COMM_SELF, base / "empty.h5");
  EXPECT_NE(error_of([&] { return nowhere.add(0, bodies_at(0)); }).find("cannot be written"), std::string::npos);
  ASSERT_EQ(changing.add(0, bodies_at(0)), 0);
  {
    const FullDisk full_disk(1024);
    EXPECT_NE(error_of([&] { return changing.add(1, bodies_at(1)); }), "no error");
  }
  EXPECT_EQ(BodyTable(base / "bodies.h5").rows(), 1u) << "the old file stays";
  EXPECT_NE(error_of([&] { return changing.add(0, {}); }).find("number of bodies"), std::string::npos);
  ASSERT_EQ(empty.add(0, {}), 0);
  ASSERT_EQ(empty.flush(), 0);
  EXPECT_FALSE(fs::exists(base / "empty.h5"));
}

// -------------------------------------------------------------------------------------------------------- progress

class ProgressOutput {
public:
  explicit ProgressOutput(Progress::Style style, const Progress::Goal &goal)
      : file_(std::tmpfile()), progress(file_, style, goal) {}
  ~ProgressOutput() { std::fclose(file_); }
  std::string text() const {
    std::string result;
    std::rewind(file_);
    for (int c; (c = std::fgetc(file_)) != EOF;) result += static_cast<char>(c);
    return result;
  }

private:
  std::FILE *file_;

public:
  Progress progress;
};

TEST(Progress, OneLineInATerminal) {
  ProgressOutput out(Progress::Style::terminal, {0, 10, 0, -1, 2e6});
  for (int n = 1; n <= 100; ++n) out.progress.update(0.1 * n, n, 0.1, 0.05 * n);
  out.progress.finish(10, 100, 0.1, 5);
  const std::string text = out.text();
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 1);
  EXPECT_EQ(text.back(), '\n');
  const auto refreshed = std::count(text.begin(), text.end(), '\r');
  EXPECT_GE(refreshed, 20);
  EXPECT_LE(refreshed, 27) << "five times a second, for five seconds";
  EXPECT_NE(text.find("100.0 %  time 10 of 10  step 100  dt 0.1  40 Mcell/s  0:00 left"), std::string::npos) << text;
}

TEST(Progress, AFewLinesInALog) {
  ProgressOutput fast(Progress::Style::log, {0, 10, 0, -1, 1}), slow(Progress::Style::log, {0, 10, 0, -1, 1}),
      endless(Progress::Style::log, {0, 1e9, 0, -1, 1}), silent(Progress::Style::silent, {0, 10, 0, -1, 1});
  for (int n = 1; n <= 1000; ++n) {
    fast.progress.update(0.01 * n, n, 0.01, 0.05 * n);    // 50 s: a line every 10 s
    slow.progress.update(0.01 * n, n, 0.01, 1.0 * n);     // 1000 s: a line every 5 %
    endless.progress.update(0.01 * n, n, 0.01, 6.0 * n);  // 6000 s and 0 %: every ten minutes
    silent.progress.update(0.01 * n, n, 0.01, 6.0 * n);
  }
  const auto lines = [](const ProgressOutput &out) {
    const std::string text = out.text();
    EXPECT_EQ(text.find('\r'), std::string::npos);
    return std::count(text.begin(), text.end(), '\n');
  };
  EXPECT_EQ(lines(fast), 1 + 4);
  EXPECT_EQ(lines(slow), 1 + 20);
  EXPECT_EQ(lines(endless), 1 + 9);
  EXPECT_EQ(lines(silent), 0);
}

TEST(Progress, TheFirstGoalCounts) {
  ProgressOutput out(Progress::Style::log, {0, 100, 0, 50, 1e6});
  out.progress.update(1, 25, 0.04, 3600);
  EXPECT_NE(out.text().find(" 50.0 %"), std::string::npos) << out.text();
  EXPECT_NE(out.text().find("1:00:00 left"), std::string::npos) << out.text();
}

}  // namespace
}  // namespace eulastic
