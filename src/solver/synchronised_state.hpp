// The flow at the time of the velocity, for measures and output. With the staggered method phases and bodies in boxes
// are half a step behind; copies of them are advanced, and the state does not change.
#pragma once

#include "parts/flow.hpp"
#include "parts/flow_part.hpp"

namespace eulastic {

class BoxedBodies;

class SynchronisedState {
public:
  SynchronisedState(Flow *flow, BoxedBodies *boxed) : flow_(*flow), boxed_(*boxed) {}

  /// Phases at the time of the velocity. Valid until the next step. Collective.
  PetscErrorCode phases(const std::vector<Phase> **phases);
  /// Bodies in boxes of this rank at the time of the velocity, with the velocity. Valid until the next step.
  /// Collective.
  PetscErrorCode bodies(std::vector<BodyInBox> *bodies);
  /// Calls observe(phases) while the phases of species whose bodies are in boxes hold these bodies on the grid: phi is
  /// the sum, B and label are those of the body with the largest phi. Collective.
  PetscErrorCode with_bodies_on_grid(const std::function<PetscErrorCode(const std::vector<Phase> &)> &observe);
  /// Calls observe() with phases() and bodies() as stored, half a step behind the velocity. Requires phases half a step
  /// behind.
  PetscErrorCode at_half_step(const Observer &observe);
  /// Calls observe() for each of `times` within the last step, with velocity and phases of that time to second order,
  /// and the pressure of the step. The state is restored. Requires the staggered method; call after a step and before
  /// phases().
  PetscErrorCode replay_last_step(const std::vector<double> &times, const Observer &observe);
  std::size_t bytes() const;

private:
  Flow &flow_;
  BoxedBodies &boxed_;
  std::vector<Phase> advanced_;  ///< result of phases(); its first B is in memory that is idle between steps
  std::int64_t advanced_step_ = -1;
  double time_before_end_ = 0;     ///< time before the end of the step
  bool half_step_behind_ = false;  ///< return phases and bodies half a step behind
};

}  // namespace eulastic
