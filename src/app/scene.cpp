#include "app/scene.hpp"

#include "base/events.hpp"
#include "bodies/fill_phase.hpp"
#include "bodies/placement.hpp"

namespace eulastic {

PetscErrorCode build_scene(const Config &config, const Grid &grid, Solver *solver, std::string *reason) {
  PetscFunctionBeginUser;
  StageScope stage(Stage::setup);
  PetscCall(solver->create(grid, {config.method, config.fluid, config.walls}));
  State &state = solver->state();
  set_initial_velocity(grid, config.walls, config.initial, state.velocity);
  int next_label = 1;
  for (const SpeciesSpec &species : config.species) {
    std::vector<BodyPlace> places;
    *reason = place_bodies(species, config.grid, &places);
    if (!reason->empty()) PetscFunctionReturn(0);
    Phase phase;
    PetscCall(fill_phase(grid, species, places, next_label, &phase));
    next_label += static_cast<int>(places.size());
    state.phases.push_back(std::move(phase));
    solver->bodies().add_phase(grid, places);
  }
  PetscCall(solver->prepare());
  PetscFunctionReturn(0);
}

}  // namespace eulastic
