// When something written at an interval of simulated time is due.
#pragma once

#include <cmath>

namespace eulastic {

/// Due at the first state at or after each multiple of the interval. All it remembers is when it was written last:
/// a restart with another interval needs nothing else.
struct Due {
  double interval = 0;    ///< 0 = never
  double last_time = -1;  ///< negative: not yet

  /// Times that are meant to hit a multiple miss it by round-off.
  double multiple(double time) const { return std::floor(time / interval + 1e-9); }
  bool at(double time) const { return interval > 0 && (last_time < 0 || multiple(time) > multiple(last_time)); }
};

}  // namespace eulastic
