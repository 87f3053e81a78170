// Schedule of an output at an interval of simulated time.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

namespace eulastic {

/// Due at the first state at or after each multiple of the interval. Its only state is the time of the last output, so
/// that a restart may change the interval.
struct Due {
  double interval = 0;    ///< 0 = never
  double last_time = -1;  ///< negative: not yet

  /// Tolerance for times that miss a multiple by round-off.
  double multiple(double time) const { return std::floor(time / interval + 1e-9); }
  /// Multiples after `from` and after the last one written, and before `to`.
  std::vector<double> between(double from, double to) const {
    std::vector<double> times;
    if (interval <= 0 || last_time < 0) return times;
    const bool at_end = std::fabs(to / interval - multiple(to)) <= 1e-9;
    const double last = multiple(to) - (at_end ? 1 : 0);
    for (double m = multiple(std::max(from, last_time)) + 1; m <= last; ++m) times.push_back(m * interval);
    return times;
  }
  bool at(double time) const { return interval > 0 && (last_time < 0 || multiple(time) > multiple(last_time)); }
};

}  // namespace eulastic
