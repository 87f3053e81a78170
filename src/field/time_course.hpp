// A number that depends on time: a constant, a cosine, or a table.
#pragma once

#include <array>
#include <vector>

namespace eulastic {

/// value cos(frequency t + phase), or a table with linear interpolation between its rows. Without a period the table is
/// constant before its first and after its last row. With a period, which is at least as long as the table, it repeats,
/// with linear interpolation from the last row to the first row of the next period.
struct TimeCourse {
  double value = 0;
  double frequency = 0;                      ///< angular, 1 / time
  double phase = 0;                          ///< rad
  std::vector<std::array<double, 2>> table;  ///< time, value, with ascending times; empty: no table
  double period = 0;                         ///< period of the table; 0: it does not repeat
  double at(double time) const;
  double rate(double time) const;       ///< derivative in time; at a row of the table that of the following piece
  double angular_frequency() const;     ///< of the repetition, >= 0; 0: none
  std::array<double, 2> range() const;  ///< smallest and largest value at any time
  double largest() const;               ///< largest absolute value at any time

private:
  /// Returns the two rows of the table around a time, which is moved into the first period; they are equal where the
  /// table is constant.
  std::array<std::array<double, 2>, 2> rows_around(double *time) const;
};

}  // namespace eulastic
