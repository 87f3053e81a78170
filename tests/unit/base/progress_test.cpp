// The progress line: its content, and how often it is printed.
#include "base/progress.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace eulastic {
namespace {

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
  EXPECT_NE(text.find("100.0 %  time 10 of 10  step 100  dt 0.1  40 Mcell/s  in 0:05"), std::string::npos) << text;
}

TEST(Progress, AFewLinesInALog) {
  ProgressOutput fast(Progress::Style::log, {0, 10, 0, -1, 1}), slow(Progress::Style::log, {0, 10, 0, -1, 1}),
      endless(Progress::Style::log, {0, 1e9, 0, -1, 1}), silent(Progress::Style::silent, {0, 10, 0, -1, 1});
  for (int n = 1; n <= 1000; ++n) {
    fast.progress.update(0.01 * n, n, 0.01, 0.05 * n);    // 50 s: a line every 10 s
    slow.progress.update(0.01 * n, n, 0.01, 1.0 * n);     // 1000 s: the first estimate, a line every 5 %
    endless.progress.update(0.01 * n, n, 0.01, 6.0 * n);  // 6000 s and 0 %: every ten minutes
    silent.progress.update(0.01 * n, n, 0.01, 6.0 * n);
  }
  const auto lines = [](const ProgressOutput &out) {
    const std::string text = out.text();
    EXPECT_EQ(text.find('\r'), std::string::npos);
    return std::count(text.begin(), text.end(), '\n');
  };
  EXPECT_EQ(lines(fast), 1 + 4);
  EXPECT_EQ(lines(slow), 1 + 1 + 20);
  EXPECT_EQ(lines(endless), 1 + 1 + 9);
  EXPECT_EQ(lines(silent), 0);
}

// Short first steps, then equal steps of one second: the remaining time is printed as soon as it is right, not before.
TEST(Progress, WhatIsLeftIsToldWhenItMeansSomething) {
  ProgressOutput out(Progress::Style::log, {0, 1000, 0, -1, 1});
  double time = 0;
  for (int n = 1; n <= 1000; ++n) {
    const double dt = n < 7 ? std::ldexp(1, n - 7) : 1;
    out.progress.update(time += dt, n, dt, n);
    EXPECT_EQ(out.text().find("left") != std::string::npos, n >= 16);
    if (n == 16) {
      EXPECT_NE(out.text().find("16:29 left"), std::string::npos) << out.text();  // 989 s; 24:00 by the mean
    }
  }
}

// The rate falls to a tenth; the estimate is right half of the run later.
TEST(Progress, WhatIsLeftFollowsTheLatterHalf) {
  ProgressOutput out(Progress::Style::terminal, {0, 1000, 0, -1, 1});
  double wall = 0;
  for (int n = 1; n <= 400; ++n) out.progress.update(n, n, 1, wall += n <= 100 ? 1 : 10);
  const std::string text = out.text();
  EXPECT_NE(text.rfind("1:40:00 left"), std::string::npos) << text.substr(text.rfind('\r'));
  EXPECT_GT(text.rfind("1:40:00 left"), text.rfind('\r'));
}

TEST(Progress, TheFirstGoalCounts) {
  ProgressOutput out(Progress::Style::log, {0, 100, 0, 50, 1e6});
  out.progress.update(1, 25, 0.04, 3600);
  EXPECT_NE(out.text().find(" 50.0 %"), std::string::npos) << out.text();
  EXPECT_NE(out.text().find("1:00:00 left"), std::string::npos) << out.text();
}

}  // namespace
}  // namespace eulastic
