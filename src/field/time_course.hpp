// A number that the user gives over time: constant, a cosine, or a table.
#pragma once

#include <array>
#include <vector>

namespace eulastic {

/// value cos(frequency t + phase); or the table, linear between its rows. Without a period it is constant before its
/// first row and after its last one; with a period, which is at least as long as the table, it repeats, and is linear
/// from its last row to its first one of the next period.
struct TimeCourse {
  double value = 0;
  double frequency = 0;                      ///< angular, 1 / time
  double phase = 0;                          ///< rad
  std::vector<std::array<double, 2>> table;  ///< time, value; times ascend. Empty: none
  double period = 0;                         ///< of the table; 0: it does not repeat
  double at(double time) const;
  double rate(double time) const;       ///< its change per time; of a table that of the piece that begins then
  double angular_frequency() const;     ///< of what repeats, >= 0; 0: nothing does
  std::array<double, 2> range() const;  ///< least and largest at any time
  double largest() const;               ///< of its size, at any time

private:
  /// The two rows of the table around a time, which is moved into the table's first period; equal where it is constant.
  std::array<std::array<double, 2>, 2> rows_around(double *time) const;
};

}  // namespace eulastic
