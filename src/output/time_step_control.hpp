// Chooses dt: measured every ten steps, changed smoothly, never shortened except to end on time.
#pragma once

#include "base/petsc.hpp"
#include "output/guards.hpp"

namespace eulastic {

/// Steps of a run of the staggered integrator that grow, before the automatic step is reached.
inline constexpr int starting_steps = 19;

class TimeStepControl {
public:
  explicit TimeStepControl(const TimeControl &time) : time_(time) {}

  /// The dt of the next step, if the guards accept it. `warning`: one line, once, if the user's dt exceeds a limit or
  /// if the run would need too many steps.
  PetscErrorCode choose(Solver *solver, const Guards &guards, double *dt, Stop *stop, std::string *warning);
  /// After choose(), before the step: resets strain that the grid does not resolve, if choose() has measured. A
  /// checkpoint between the two calls restarts to the same bits.
  PetscErrorCode reset_unresolved(Solver *solver, std::string *warning);

  /// The dt of the last choose() ends the run exactly at -time_end.
  bool ends() const { return ends_; }
  /// dt since the last measurement: with the state, all a restart needs.
  double dt() const { return dt_; }
  void resume(double dt) { dt_ = dt; }

private:
  std::string too_many_steps(const State &state) const;

  TimeControl time_;
  double dt_ = 0;  ///< since the last measurement
  FlowExtremes extremes_;
  bool measured_ = false;  ///< by the last choose()
  bool warned_ = false, unresolved_ = false, ends_ = false;
};

}  // namespace eulastic
