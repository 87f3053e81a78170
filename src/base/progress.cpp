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
  // The mpiexec of Open MPI gives rank 0 a terminal of its own, whatever its output goes to.
  const bool is_ours = std::getenv("OMPI_COMM_WORLD_RANK") == nullptr;
  return is_ours && ::isatty(::fileno(out)) ? Style::terminal : Style::log;
}

// The run ends when the first of the two goals is reached.
double Progress::fraction(double time, long step) const {
  double done = 0;
  if (goal_.time_end > goal_.time_begin) done = (time - goal_.time_begin) / (goal_.time_end - goal_.time_begin);
  if (goal_.steps_max > goal_.steps_begin)
    done = std::max(done, double(step - goal_.steps_begin) / double(goal_.steps_max - goal_.steps_begin));
  return std::clamp(done, 0.0, 1.0);
}

double Progress::left(long step, const Mark &now) const {
  constexpr long few = 16;  // the staggered integrator starts with six steps that double
  if (step - goal_.steps_begin < few || now.wall - earlier_.wall < 1 || now.done <= earlier_.done) return -1;
  return (now.wall - earlier_.wall) * (1 - now.done) / (now.done - earlier_.done);
}

std::string Progress::line(double time, long step, double dt, double wall) const {
  const double rate = wall > 0 ? goal_.cells * double(step - goal_.steps_begin) / wall * 1e-6 : 0;
  return eulastic::print("%5.1f %%  time %.6g of %.6g  step %ld  dt %.3g  %.3g Mcell/s", 100 * fraction(time, step),
                         time, goal_.time_end, step, dt, rate);
}

void Progress::print(const std::string &text, double wall) {
  // \033[K clears what a longer line left behind.
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
  const double since = wall - last_wall_, seconds = left(step, now);
  const int mark = static_cast<int>(20 * now.done + 1e-9);
  const bool news = mark > last_mark_ || (seconds >= 0 && !estimated_);
  const bool due = style_ == Style::terminal ? since >= 0.2 : (news && since >= 10) || since >= 600;
  if (!due) return;
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
