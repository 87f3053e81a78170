#include "app/time_step_control.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace eulastic {
namespace {

constexpr int euler_interval =
    10;                          // steps between measurements; the large steps of the staggered scheme look each time
constexpr double growth = 1.05;  // most that dt grows from one measurement to the next

std::string not_finite(const Solver &solver, double cell, double dt, const TimeStepLimits &limits) {
  const Int3 &n = solver.grid().cells();
  const Real3 &h = solver.grid().spacing();
  const double i = std::fmod(cell, n[0]), j = std::fmod(std::floor(cell / n[0]), n[1]);
  const double k = std::floor(cell / n[0] / n[1]);
  char text[320];
  const char *broken = limits.broken(dt);
  std::snprintf(text, sizeof text,
                "a field is not finite at t = %.9g (step %lld) near x, y, z = %.6g, %.6g, %.6g; dt = %.3g, %s%s",
                solver.state().time, static_cast<long long>(solver.state().step), (i + 0.5) * h[0], (j + 0.5) * h[1],
                (k + 0.5) * h[2], dt, broken ? broken : "no known limit", broken ? " limit exceeded" : " exceeded");
  return text;
}

}  // namespace

PetscErrorCode TimeStepControl::choose(Solver *solver, double *dt, std::string *stop, std::string *warning) {
  PetscFunctionBeginUser;
  const State &state = solver->state();
  const int interval = solver->spec().staggered() ? 1 : euler_interval;
  if (state.step % interval == 0 || dt_ == 0) {
    FlowExtremes extremes;
    PetscCall(solver->measure(&extremes));
    const TimeStepLimits limits = solver->limits(extremes);
    if (extremes.first_bad >= 0) {
      *stop = not_finite(*solver, extremes.first_bad, state.dt, limits);
      PetscFunctionReturn(0);
    }
    if (time_.step > 0) {
      dt_ = time_.step;
      if (const char *limit = limits.broken(dt_); limit && !warned_) {
        char text[200];
        std::snprintf(text, sizeof text, "-time_step %g is beyond the %s limit (automatic: %g)", dt_, limit,
                      limits.automatic());
        *warning = text;
        warned_ = true;
      }
    } else {
      dt_ = limits.automatic();
      if (state.dt > 0) dt_ = std::min(dt_, growth * state.dt);
    }
  }
  *dt = dt_;
  if (time_.end > 0) {
    const double left = time_.end - state.time;
    ends_ = left <= *dt * (1 + 1e-9);
    if (ends_) *dt = left;
  }
  PetscFunctionReturn(0);
}

}  // namespace eulastic
