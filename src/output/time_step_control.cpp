#include "output/time_step_control.hpp"

#include "base/one_line.hpp"
#include "solids/unresolved.hpp"

#include <algorithm>
#include <cmath>

namespace eulastic {
namespace {

constexpr int euler_interval = 10;  // steps between measurements; large steps look each time
constexpr double growth = 1.05;     // most that dt grows from one measurement to the next
// The staggered scheme starts with small steps that grow with the time that has passed: a flow that starts changes on
// that scale, whatever the limits are, it need not balance the forces, RKL2 brings stiff modes only about half way in a
// step, and solids meanwhile move with what there is. docs/method.md, section 8.
constexpr double starting_growth = 1.25;
constexpr double many_steps = 1e9;

// The numbers of such a body mean little.
std::string unresolved(const State &state) {
  return print(
      "t = %.9g: the grid does not resolve the strain of a body (det B > %g, or half of a membrane's area gone), "
      "part of which is lost there; use more -grid_cells",
      state.time, largest_determinant);
}

}  // namespace

PetscErrorCode TimeStepControl::choose(Solver *solver, const Guards &guards, double *dt, Stop *stop,
                                       std::string *warning) {
  PetscFunctionBeginUser;
  const State &state = solver->state();
  const bool staggered = solver->spec().staggered();
  const int interval = staggered ? 1 : euler_interval;
  const bool look = state.step % interval == 0 || dt_ == 0;
  measured_ = look;
  if (look) {
    extremes_ = {};
    PetscCall(solver->measure(&extremes_));
    const TimeStepLimits limits = solver->limits(extremes_);
    if (time_.step > 0) {
      dt_ = time_.step;
      if (const char *limit = limits.exceeded_limit(dt_); limit && !warned_) {
        *warning = print("-time_step %g exceeds the %s limit (automatic: %g)", dt_, limit, limits.automatic());
      }
    } else {
      dt_ = limits.automatic();
      const bool starts = staggered && state.step < starting_steps;
      if (starts && state.step == 0) dt_ *= std::pow(starting_growth, -starting_steps);
      if (state.dt > 0) dt_ = std::min(dt_, (starts ? starting_growth : growth) * state.dt);
    }
    if (warning->empty() && !warned_) *warning = too_many_steps(state);
    warned_ = warned_ || !warning->empty();
  }
  *dt = dt_;
  if (time_.end > 0) {
    const double left = time_.end - state.time;
    ends_ = left <= *dt * (1 + 1e-9);
    if (ends_) *dt = left;
  }
  if (look) PetscCall(guards.before_step(*solver, extremes_, *dt, stop));
  PetscFunctionReturn(0);
}

PetscErrorCode TimeStepControl::reset_unresolved(Solver *solver, std::string *warning) {
  PetscFunctionBeginUser;
  if (!measured_) PetscFunctionReturn(0);
  PetscCall(solver->reset_unresolved(extremes_));
  if (solver->state().forgotten == 0 || unresolved_ || !warning->empty()) PetscFunctionReturn(0);
  *warning = unresolved(solver->state());
  unresolved_ = true;
  PetscFunctionReturn(0);
}

// One line if the run will hardly end.
std::string TimeStepControl::too_many_steps(const State &state) const {
  double steps = (time_.end - state.time) / dt_;
  if (time_.steps_max > 0) steps = std::min(steps, double(time_.steps_max) - double(state.step));
  if (!(steps > many_steps)) return {};
  return print("-time_end %g is %.2g steps of %.3g away; check the units", time_.end, steps, dt_);
}

}  // namespace eulastic
