// Tables over time: between their rows, outside of them, and with a period.
#include "field/time_course.hpp"

#include <gtest/gtest.h>

#include <cmath>

using namespace eulastic;

TEST(TimeCourse, IsLinearBetweenRowsAndConstantOutside) {
  const TimeCourse course{0, 0, 0, {{1, 2}, {3, 6}, {4, 5}}};
  const double wanted[][3] = {{-1, 2, 0}, {1, 2, 2}, {2, 4, 2}, {3, 6, -1}, {3.5, 5.5, -1}, {4, 5, 0}, {9, 5, 0}};
  for (const auto &[time, value, rate] : wanted) {
    EXPECT_DOUBLE_EQ(course.at(time), value) << time;
    EXPECT_DOUBLE_EQ(course.rate(time), rate) << time;
  }
}

TEST(TimeCourse, RepeatsWithItsPeriod) {
  TimeCourse course{0, 0, 0, {{1, 2}, {3, 6}}};
  course.period = 4;  // from 6 back to 2 between t = 3 and t = 5
  EXPECT_DOUBLE_EQ(course.angular_frequency(), std::acos(-1) / 2);
  const double wanted[][3] = {{0, 4, -2}, {1, 2, 2}, {2, 4, 2}, {3, 6, -2}, {4, 4, -2}, {5, 2, 2}, {4002, 4, 2}};
  for (const auto &[time, value, rate] : wanted) {
    EXPECT_DOUBLE_EQ(course.at(time), value) << time;
    EXPECT_DOUBLE_EQ(course.rate(time), rate) << time;
  }
}
