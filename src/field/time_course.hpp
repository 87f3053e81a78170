// A number that the user gives over time: constant, a cosine, or a table.
#pragma once

#include <array>
#include <vector>

namespace eulastic {

/// value cos(frequency t + phase); or the table, linear between its rows and constant before and after them.
struct TimeCourse {
  double value = 0;
  double frequency = 0;                      ///< angular, 1 / time
  double phase = 0;                          ///< rad
  std::vector<std::array<double, 2>> table;  ///< time, value; times ascend. Empty: none
  double at(double time) const;
  double rate(double time) const;       ///< its change per time; of a table that of the piece that begins then
  std::array<double, 2> range() const;  ///< least and largest at any time
  double largest() const;               ///< of its size, at any time
};

}  // namespace eulastic
