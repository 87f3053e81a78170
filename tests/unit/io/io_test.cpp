// Text files and tables: whole or not at all, and every number as it was.
#include "io/series.hpp"
#include "io/text_file.hpp"
#include "support/files.hpp"

#include <cmath>

namespace eulastic {
namespace {

using namespace test;

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

}  // namespace
}  // namespace eulastic
