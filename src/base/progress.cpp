#include "base/progress.hpp"

#include "base/one_line.hpp"

#include <unistd.h>
#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace eulastic {
namespace {

std::string duration(double seconds) {
  if (!(seconds < 3.6e8)) return "?";
  const long s = std::lround(seconds);
  return s >= 3600 ? print("%ld:%02ld:%02ld", s / 3600, s / 60 % 60, s % 60) : print("%ld:%02ld", s / 60, s % 60);
}

}  // namespace

Progress::Style Progress::style_of(std::FILE *out, int rank) {
  if (rank != 0) return Style::silent;
  // The mpiexec of Open MPI gives rank 0 a pseudo-terminal even if its output is redirected to a file.
  const bool is_direct = std::getenv("OMPI_COMM_WORLD_RANK") == nullptr;
  return is_direct && ::isatty(::fileno(out)) ? Style::terminal : Style::log;
}

// The run ends when the first of its two limits, time or steps, is reached.
double Progress::fraction(double time, long step) const {
  double done = 0;
  if (goal_.time_end > goal_.time_begin) done = (time - goal_.time_begin) / (goal_.time_end - goal_.time_begin);
  if (goal_.steps_max > goal_.steps_begin)
    done = std::max(done, double(step - goal_.steps_begin) / double(goal_.steps_max - goal_.steps_begin));
  return std::clamp(done, 0.0, 1.0);
}

double Progress::seconds_left(long step, const Mark &now) const {
  constexpr long steps_needed = 16;  // the automatic time step is small at the start
  if (step - goal_.steps_begin < steps_needed || now.wall - earlier_.wall < 1 || now.done <= earlier_.done) return -1;
  return (now.wall - earlier_.wall) * (1 - now.done) / (now.done - earlier_.done);
}

std::string Progress::line(double time, long step, double dt, double wall) const {
  const double rate = wall > 0 ? goal_.cells * double(step - goal_.steps_begin) / wall * 1e-6 : 0;
  return eulastic::print("%5.1f %%  time %.6g of %.6g  step %ld  dt %.3g  %.3g Mcell/s", 100 * fraction(time, step),
                         time, goal_.time_end, step, dt, rate);
}

void Progress::print(const std::string &text, double wall) {
  // The escape sequence \033[K clears the rest of a longer previous line.
  std::fprintf(out_, style_ == Style::terminal ? "\r%s\033[K" : "%s\n", text.c_str());
  std::fflush(out_);
  last_wall_ = wall;
}

void Progress::update(double time, long step, double dt, double wall) {
  if (style_ == Style::silent) return;
  const Mark now{fraction(time, step), wall};
  if (const long steps = step - goal_.steps_begin; steps >= next_) {
    earlier_ = latest_;
    latest_ = now;
    next_ = 2 * steps;
  }
  const double since = wall - last_wall_, seconds = seconds_left(step, now);
  const int mark = static_cast<int>(20 * now.done + 1e-9);
  const bool notable = mark > last_mark_ || (seconds >= 0 && !estimated_);
  const bool print_now = style_ == Style::terminal ? since >= 0.2 : (notable && since >= 10) || since >= 600;
  if (!print_now) return;
  print(line(time, step, dt, wall) + (seconds < 0 ? "" : "  " + duration(seconds) + " left"), wall);
  last_mark_ = mark;
  estimated_ = estimated_ || seconds >= 0;
}

void Progress::finish(double time, long step, double dt, double wall) {
  if (style_ == Style::silent) return;
  print(line(time, step, dt, wall) + "  in " + duration(wall), wall);
  if (style_ == Style::terminal) std::fputc('\n', out_);
  std::fflush(out_);
}

}  // namespace eulastic
