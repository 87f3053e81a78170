#include "field/time_course.hpp"

#include <algorithm>
#include <cmath>

namespace eulastic {

double TimeCourse::at(double time) const {
  if (table.empty()) return frequency == 0 && phase == 0 ? value : value * std::cos(frequency * time + phase);
  const auto after = std::upper_bound(table.begin(), table.end(), time,
                                      [](double t, const std::array<double, 2> &row) { return t < row[0]; });
  if (after == table.begin()) return table.front()[1];
  if (after == table.end()) return table.back()[1];
  const auto &[t0, low] = after[-1];
  const auto &[t1, high] = *after;
  return low + (high - low) * ((time - t0) / (t1 - t0));
}

double TimeCourse::rate(double time) const {
  if (table.empty()) return frequency == 0 ? 0 : -value * frequency * std::sin(frequency * time + phase);
  const auto after = std::upper_bound(table.begin(), table.end(), time,
                                      [](double t, const std::array<double, 2> &row) { return t < row[0]; });
  if (after == table.begin() || after == table.end()) return 0;
  return ((*after)[1] - after[-1][1]) / ((*after)[0] - after[-1][0]);
}

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
