// The flow as those see it who measure it: all of it at the time of the velocity. With the staggered scheme phases and
// bodies in boxes live half a step behind; copies are brought up, the state is not touched.
#pragma once

#include "parts/flow.hpp"
#include "parts/flow_part.hpp"

namespace eulastic {

class BoxedBodies;

class Looks {
public:
  Looks(Flow *flow, BoxedBodies *boxed) : flow_(*flow), boxed_(*boxed) {}

  /// Valid until the next step.
  PetscErrorCode phases(const std::vector<Phase> **phases);
  /// Bodies of this rank in boxes of their own, with the velocity. Valid until the next step. Collective.
  PetscErrorCode bodies(std::vector<BodyInBox> *bodies);
  /// Calls look(phases) where species whose bodies lie in boxes have them on the grid: phi is the sum, B and the label
  /// are of the body that fills most. Collective.
  PetscErrorCode on_grid(const std::function<PetscErrorCode(const std::vector<Phase> &)> &look);
  /// Calls look() with phases() and bodies() half a step behind, as they are. Only where Flow::is_behind().
  PetscErrorCode behind(const Look &look);
  /// Calls look() for each of `times` within the last step, with velocity and phases of that time, to second order;
  /// pressure is that of the step. The state is then what it was. Only with the staggered scheme, after a step and
  /// before phases().
  PetscErrorCode back(const std::vector<double> &times, const Look &look);
  std::size_t bytes() const;

private:
  Flow &flow_;
  BoxedBodies &boxed_;
  std::vector<Phase> copies_;  ///< for phases(), the first B in memory that lies idle between steps
  std::int64_t copies_step_ = -1;
  double back_ = 0;           ///< before the end of the step
  bool as_they_are_ = false;  ///< half a step behind
};

}  // namespace eulastic
