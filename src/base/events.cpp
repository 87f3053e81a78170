#include "base/events.hpp"

#include "base/team.hpp"

#include <array>

namespace eulastic {
namespace {

constexpr int event_count = static_cast<int>(Event::count);
constexpr int stage_count = static_cast<int>(Stage::count);
constexpr std::array<const char *, event_count> event_names = {
    "EulExchange",   "EulWait",     "EulWallGhosts", "EulMomentum", "EulViscous", "EulTension", "EulMembrane",
    "EulAdhesion",   "EulRigid",    "EulDivergence", "EulACM",      "EulSMAC",    "EulCorrect", "EulFraction",
    "EulLeftCauchy", "EulExterior", "EulBodies",     "EulBoxes",    "EulThreads", "EulSums",    "EulWrite"};
constexpr std::array<const char *, stage_count> stage_names = {"Setup", "Step", "Output"};
constexpr std::array<const char *, stage_count> stage_events = {"EulSetup", "EulStep", "EulOutput"};

PetscLogEvent event_ids[event_count], stage_event_ids[stage_count];
PetscLogStage stage_ids[stage_count];
bool registered = false;

}  // namespace

PetscErrorCode register_events() {
  PetscFunctionBeginUser;
  if (registered) PetscFunctionReturn(0);
  PetscClassId class_id;
  PetscCall(PetscClassIdRegister("Eulastic", &class_id));
  for (int e = 0; e < event_count; ++e) PetscCall(PetscLogEventRegister(event_names[e], class_id, &event_ids[e]));
  for (int s = 0; s < stage_count; ++s) {
    PetscCall(PetscLogStageRegister(stage_names[s], &stage_ids[s]));
    PetscCall(PetscLogEventRegister(stage_events[s], class_id, &stage_event_ids[s]));
  }
  registered = true;
  PetscFunctionReturn(0);
}

// A member of a team logs no events: the calling thread adds its flops to the event around the parallel region.
EventScope::EventScope(Event event) : event_(event) {
  if (registered && !TeamMember::is_here()) (void)PetscLogEventBegin(event_ids[static_cast<int>(event)], 0, 0, 0, 0);
}

EventScope::~EventScope() {
  if (TeamMember::is_here()) {
    TeamMember::add_flops(flops_);
    return;
  }
  if (!registered) return;
  (void)PetscLogFlops(flops_);
  (void)PetscLogEventEnd(event_ids[static_cast<int>(event_)], 0, 0, 0, 0);
}

StageScope::StageScope(Stage stage) : stage_(stage) {
  if (!registered) return;
  (void)PetscLogStagePush(stage_ids[static_cast<int>(stage)]);
  (void)PetscLogEventBegin(stage_event_ids[static_cast<int>(stage)], 0, 0, 0, 0);
}

StageScope::~StageScope() {
  if (!registered) return;
  (void)PetscLogEventEnd(stage_event_ids[static_cast<int>(stage_)], 0, 0, 0, 0);
  (void)PetscLogStagePop();
}

}  // namespace eulastic
