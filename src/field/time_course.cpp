#include "field/time_course.hpp"

#include <algorithm>
#include <cmath>

namespace eulastic {

std::array<std::array<double, 2>, 2> TimeCourse::rows_around(double *time) const {
  const double begin = table.front()[0];
  if (period > 0) {
    const double elapsed = std::fmod(*time - begin, period);
    *time = begin + (elapsed < 0 ? elapsed + period : elapsed);
  }
  const auto after = std::upper_bound(table.begin(), table.end(), *time,
                                      [](double t, const std::array<double, 2> &row) { return t < row[0]; });
  if (after == table.begin()) return {*after, *after};
  if (after != table.end()) return {after[-1], *after};
  if (period > 0) return {table.back(), {begin + period, table.front()[1]}};
  return {table.back(), table.back()};
}

double TimeCourse::at(double time) const {
  if (table.empty()) return frequency == 0 && phase == 0 ? value : value * std::cos(frequency * time + phase);
  const auto [before, after] = rows_around(&time);
  const double length = after[0] - before[0];
  return length > 0 ? before[1] + (after[1] - before[1]) * ((time - before[0]) / length) : before[1];
}

double TimeCourse::rate(double time) const {
  if (table.empty()) return frequency == 0 ? 0 : -value * frequency * std::sin(frequency * time + phase);
  const auto [before, after] = rows_around(&time);
  const double length = after[0] - before[0];
  return length > 0 ? (after[1] - before[1]) / length : 0;
}

double TimeCourse::angular_frequency() const { return period > 0 ? 2 * M_PI / period : std::fabs(frequency); }

std::array<double, 2> TimeCourse::range() const {
  if (table.empty()) {
    const double size = std::fabs(value);
    return frequency != 0 ? std::array{-size, size} : std::array{at(0), at(0)};
  }
  std::array<double, 2> range{table[0][1], table[0][1]};
  for (const auto &row : table) range = {std::min(range[0], row[1]), std::max(range[1], row[1])};
  return range;
}

double TimeCourse::largest() const {
  const auto [low, high] = range();
  return std::max(std::fabs(low), std::fabs(high));
}

}  // namespace eulastic
