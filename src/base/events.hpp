// Events and stages of -log_view, as scopes that begin with their construction and end with their destruction.
#pragma once

#include "base/petsc.hpp"

namespace eulastic {

/// The routines that -log_view shows as events.
enum class Event {
  exchange,
  wait,
  wall_ghosts,
  momentum,
  viscous,
  surface_tension,
  membrane,
  adhesion,
  rigid,
  divergence,
  acm,
  smac,
  correction,
  solid_fraction,
  left_cauchy_green,
  exterior,
  bodies,
  boxes,
  threads,
  sums,
  write,
  count
};

/// The stages of -log_view.
enum class Stage { setup, step, output, count };

/// Registers all events and stages; call once after PetscInitialize.
PetscErrorCode register_events();

/// Logs one event from construction to destruction. `flops` may be added at any time in between.
class EventScope {
public:
  explicit EventScope(Event event);
  ~EventScope();
  EventScope(const EventScope &) = delete;
  EventScope &operator=(const EventScope &) = delete;
  void flops(double count) noexcept { flops_ += count; }

private:
  Event event_;
  double flops_ = 0;
};

/// A stage of -log_view, with an event of its own around it: the nested table (-log_view :FILE:ascii_xml) has no
/// stages.
class StageScope {
public:
  explicit StageScope(Stage stage);
  ~StageScope();
  StageScope(const StageScope &) = delete;
  StageScope &operator=(const StageScope &) = delete;

private:
  Stage stage_;
};

}  // namespace eulastic
