#include "solver/synchronised_state.hpp"

#include "bodies/labels.hpp"
#include "boxes/boxed_bodies.hpp"

#include <utility>

namespace eulastic {

std::size_t SynchronisedState::bytes() const {
  std::size_t sum = 0;
  for (const Phase &phase : advanced_) sum += phase.bytes();
  return sum;
}

PetscErrorCode SynchronisedState::phases(const std::vector<Phase> **phases) {
  State &now = flow_.now;
  PetscFunctionBeginUser;
  *phases = &now.phases;
  if (!flow_.phases_lag() || half_step_behind_) PetscFunctionReturn(0);
  *phases = &advanced_;
  if (advanced_step_ == now.step) PetscFunctionReturn(0);
  advanced_.resize(now.phases.size());
  for (std::size_t p = 0; flow_.memory && p < advanced_.size(); ++p)
    if (now.phases[p].material.carries_tensor()) {
      advanced_[p].tensor.field = flow_.borrow_idle_memory(now.phases[p].tensor.field.count());
      break;
    }
  for (std::size_t p = 0; p < advanced_.size(); ++p) advanced_[p].copy_from(now.phases[p]);
  for (FlowPart *part : flow_.parts) PetscCall(part->move(0.5 * now.dt - time_before_end_, &advanced_));
  for (FlowPart *part : flow_.parts) PetscCall(part->position_phases(now.time, &advanced_));
  for (Phase &copy : advanced_)
    if (copy.label) PetscCall(carry_labels(flow_.domain, flow_.exchange, &copy));  // label the cells it has reached
  advanced_step_ = now.step;
  PetscFunctionReturn(0);
}

PetscErrorCode SynchronisedState::bodies(std::vector<BodyInBox> *bodies) {
  return boxed_.synchronise(flow_.phases_lag() && !half_step_behind_ ? 0.5 * flow_.now.dt - time_before_end_ : 0,
                            bodies);
}

PetscErrorCode SynchronisedState::with_bodies_on_grid(
    const std::function<PetscErrorCode(const std::vector<Phase> &)> &observe) {
  const std::vector<Phase> *measured = nullptr;
  std::vector<BodyInBox> boxed;
  PetscFunctionBeginUser;
  PetscCall(phases(&measured));
  PetscCall(bodies(&boxed));
  std::vector<Phase> &all = measured == &advanced_ ? advanced_ : flow_.now.phases;
  PetscCall(boxed_.with_bodies_on_grid(boxed, &all, [&] { return observe(all); }));
  PetscFunctionReturn(0);
}

// Labels and travelling rigid bodies are updated on a schedule of the run. For observers they are brought up to date in
// copies, which are swapped in and out.
PetscErrorCode SynchronisedState::at_half_step(const Observer &observe) {
  State &now = flow_.now;
  PetscFunctionBeginUser;
  advanced_step_ = -1;
  advanced_.resize(now.phases.size());
  const auto swap = [this, &now] {
    boxed_.discard_copies();
    for (std::size_t p = 0; p < advanced_.size(); ++p) {
      Phase &phase = now.phases[p], &copy = advanced_[p];
      if (phase.label) phase.label.swap(copy.label);
      if (!phase.travels) continue;
      phase.fraction.swap(copy.fraction);
      std::swap(phase.rows, copy.rows);
    }
    half_step_behind_ = !half_step_behind_;
  };
  for (std::size_t p = 0; p < advanced_.size(); ++p) {
    const Phase &phase = now.phases[p];
    if (phase.label) advanced_[p].label.copy_from(phase.label);
    if (!phase.travels) continue;
    advanced_[p].fraction.copy_from(phase.fraction);
    advanced_[p].rows = phase.rows;
  }
  swap();
  struct Restore {
    const decltype(swap) &undo;
    ~Restore() { undo(); }
  } const restore{swap};
  for (FlowPart *part : flow_.parts) PetscCall(part->position_phases(now.time, &now.phases));
  for (Phase &phase : now.phases)
    if (phase.label) PetscCall(label_new_cells(flow_.domain, flow_.exchange, &phase));
  PetscCall(observe());
  PetscFunctionReturn(0);
}

PetscErrorCode SynchronisedState::replay_last_step(const std::vector<double> &times, const Observer &observe) {
  State &now = flow_.now;
  PetscFunctionBeginUser;
  if (times.empty()) PetscFunctionReturn(0);
  Field begin, end;
  begin.copy_from(flow_.velocity_star);  // the projection has swapped the two
  end.copy_from(now.velocity);
  struct Restore {
    SynchronisedState *of;
    const Field &velocity;
    double time;
    ~Restore() {
      of->flow_.now.velocity.copy_from(velocity);
      of->flow_.now.time = time;
      of->time_before_end_ = 0;
      of->advanced_step_ = -1;
      of->boxed_.discard_copies();
    }
  } const restore{this, end, now.time};
  const std::ptrdiff_t values = end.count() * end.layout().size;
  for (const double time : times) {
    time_before_end_ = restore.time - time;
    advanced_step_ = -1;
    boxed_.discard_copies();
    now.time = time;
    const double share = time_before_end_ / now.dt, *from = begin.data(), *to = end.data();
    double *velocity = now.velocity.data();
    for (std::ptrdiff_t i = 0; i < values; ++i) velocity[i] = to[i] + share * (from[i] - to[i]);
    PetscCall(observe());
  }
  PetscFunctionReturn(0);
}

}  // namespace eulastic
