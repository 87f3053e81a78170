// What a running solver says of itself: one refreshing line on a terminal, a line now and then in a log.
#pragma once

#include <cstdio>
#include <string>
#include "base/one_line.hpp"

namespace eulastic {

class Progress {
public:
  enum class Style { silent, terminal, log };
  struct Goal {
    double time_begin = 0, time_end = 0;   ///< simulated
    long steps_begin = 0, steps_max = -1;  ///< negative: no limit
    double cells = 0;                      ///< cells that one step updates, for the rate
  };

  /// Terminal or log, whichever `out` is, but log under the mpiexec of Open MPI; silent on every rank but 0.
  static Style style_of(std::FILE *out, int rank);

  Progress(std::FILE *out, Style style, const Goal &goal) : out_(out), style_(style), goal_(goal) {}

  /// After every step; `wall` = seconds since the loop began. Refreshes five times a second on a terminal; in a log
  /// the first step, the first estimate of the time left, then a line at every 5 %, but not within 10 s of the last one
  /// and never more than 10 minutes apart.
  void update(double time, long step, double dt, double wall);
  /// The last line, and the end of it.
  void finish(double time, long step, double dt, double wall);

private:
  struct Mark {
    double done = 0, wall = 0;
  };
  double fraction(double time, long step) const;
  /// Seconds, by the rate of the latter half of the run so far; negative as long as that means nothing: the first steps
  /// of a run are short, and machines wake up.
  double left(long step, const Mark &now) const;
  std::string line(double time, long step, double dt, double wall) const;  ///< without what is left
  void print(const std::string &text, double wall);

  std::FILE *out_;
  Style style_;
  Goal goal_;
  double last_wall_ = -1e30;
  int last_mark_ = 0;      ///< in units of 5 %
  long next_ = 8;          ///< step, counted from the begin, of the next mark
  Mark latest_, earlier_;  ///< at steps 8, 16, 32, ...
  bool estimated_ = false;
};

}  // namespace eulastic
