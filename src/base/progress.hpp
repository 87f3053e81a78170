// Reports the progress of a run: one refreshing line on a terminal, occasional lines in a log.
#pragma once

#include <cstdio>
#include <string>
#include "base/one_line.hpp"

namespace eulastic {

/// The progress report of one run.
class Progress {
public:
  enum class Style { silent, terminal, log };
  /// The range of times and steps of the run, and its size.
  struct Goal {
    double time_begin = 0, time_end = 0;   ///< simulated time
    long steps_begin = 0, steps_max = -1;  ///< a negative steps_max means no limit
    double cells = 0;                      ///< cells that one step updates
  };

  /// Returns the style for `out`: log if it is no terminal or under the mpiexec of Open MPI; silent on every rank but
  /// 0.
  static Style style_of(std::FILE *out, int rank);

  Progress(std::FILE *out, Style style, const Goal &goal) : out_(out), style_(style), goal_(goal) {}

  /// Call after every step; `wall` is the time in seconds since the loop began. A terminal is refreshed five times a
  /// second. A log gets the first step, the first estimate of the remaining time, and a line for every 5 %, at least 10
  /// s and at most 10 minutes apart.
  void update(double time, long step, double dt, double wall);
  /// Prints the last line and ends it.
  void finish(double time, long step, double dt, double wall);

private:
  /// Fraction of the run that was done at a wall time in seconds.
  struct Mark {
    double done = 0, wall = 0;
  };
  double fraction(double time, long step) const;
  /// Returns the remaining time in seconds, extrapolated from the later half of the run so far, or a negative number
  /// while an estimate is not reliable: the first steps of a run are short.
  double seconds_left(long step, const Mark &now) const;
  std::string line(double time, long step, double dt, double wall) const;  ///< without the remaining time
  void print(const std::string &text, double wall);

  std::FILE *out_;
  Style style_;
  Goal goal_;
  double last_wall_ = -1e30;
  int last_mark_ = 0;      ///< last printed mark in units of 5 %
  long next_ = 8;          ///< number of steps since the start at which the next mark is taken
  Mark latest_, earlier_;  ///< taken at steps 8, 16, 32, ...
  bool estimated_ = false;
};

}  // namespace eulastic
