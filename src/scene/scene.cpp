#include "scene/scene.hpp"

#include "base/events.hpp"
#include "bodies/fill_phase.hpp"
#include "bodies/near_places.hpp"
#include "bodies/unwrap.hpp"
#include "boxes/boxed_bodies.hpp"
#include "io/fail_together.hpp"
#include "rigid/rigid_bodies.hpp"
#include "scene/initial_state.hpp"
#include "scene/openings.hpp"
#include "scene/rigid_paths.hpp"
#include "scene/voxels.hpp"

#include <algorithm>
#include <cmath>

namespace eulastic {
namespace {

// Bodies from a file start with an arbitrary cell as reference: moves the references to their centres, in the box.
PetscErrorCode set_reference_centres(const Domain &domain, const State &state, BodyTracker *bodies) {
  PetscFunctionBeginUser;
  for (int turn = 0; turn < 2; ++turn) PetscCall(bodies->follow(domain, state.phases));
  bodies->wrap(domain);
  PetscFunctionReturn(0);
}

struct Numbering {
  int species, first_label;
};

// Each body in a box of its own, on the rank that has its centre; the phase of the species stays empty.
PetscErrorCode box_places(const Domain &domain, const SpeciesSpec &species, const Places &near,
                          const Numbering &numbering, Solver *solver, Phase *phase) {
  PetscFunctionBeginUser;
  phase->species = species.name;
  phase->material = species.material();
  phase->boxed = true;
  phase->empty(domain, false);
  const Surface surface(species, domain.dimension());
  for (const NumberedPlace &place : near.known) {
    const Int3 cell = cell_of(domain, place.centre);
    if (domain.owner(cell[0], cell[1], cell[2]) != domain.rank()) continue;
    const Box box = box_of_body(domain.domain_shape(), surface, place, 0, domain.spec().ghosts);
    PetscCall(solver->boxed().add(numbering.first_label + place.index, numbering.species, box,
                                  fill_body(box, species, surface, place)));
  }
  PetscFunctionReturn(0);
}

PetscErrorCode fill_state(const Config &config, const Domain &domain, Solver *solver) {
  PetscFunctionBeginUser;
  State &state = solver->state();
  set_initial_velocity(domain, config.sides, config.initial, state.velocity);
  InitialState file(config, domain);
  PetscCall(file.open());
  PetscCall(file.read_flow(&state));
  int next_label = 1;
  auto rigid = std::make_unique<RigidBodies>(domain, solver->exchange());
  for (std::size_t s = 0; s < config.species.size(); ++s) {
    const SpeciesSpec &species = config.species[s];
    Places placed = config.places[s], near;
    PetscCall(send_to_near_ranks(domain.comm(), domain, species, placed, &near));
    Phase phase;
    if (config.lies_in_boxes(s) && !file.holds(species)) {
      PetscCall(box_places(domain, species, near, {static_cast<int>(s), next_label}, solver, &phase));
    } else {
      PetscCall(fill_phase(domain, species, near, next_label, &phase));
      if (species.shape == Shape::voxels) PetscCall(fill_voxels(domain, species, next_label, &phase, &placed));
      PetscCall(file.read_phase(species, next_label, &phase, &placed));
      phase.boxed = config.lie_in_boxes(s, placed.count);  // those of the file, too
    }
    if (species.law == Law::rigid) {
      std::string wrong;
      PetscCall(rigid->add(species, config.places[s], next_label, &phase, &wrong));
      if (wrong.empty() && species.shape == Shape::voxels && species.travels(domain.dimension()))
        wrong = check_path(config, species, *rigid->newest_surface(), {species.centre, {}});
      PetscCall(fail_together(domain.comm(), wrong));
    }
    next_label += placed.count;
    state.phases.push_back(std::move(phase));
    solver->bodies().add_phase(domain, config.body_series ? placed : Places());
    if (!config.body_series) state.phases.back().label = Field();
  }
  PetscCall(solver->set_rigid(std::move(rigid)));
  if (config.body_series && file.has_bodies()) PetscCall(set_reference_centres(domain, state, &solver->bodies()));
  for (std::size_t s = 0; s < config.species.size(); ++s)
    if (state.phases[s].boxed && file.holds(config.species[s]))
      PetscCall(solver->boxed().take_from_grid(static_cast<int>(s)));
  PetscFunctionReturn(0);
}

}  // namespace

PetscErrorCode build_scene(const Config &config, const Domain &domain, Solver *solver, std::string *reason) {
  PetscFunctionBeginUser;
  StageScope stage(Stage::setup);
  BoundaryConditions sides = config.sides;
  PetscCall(solver->create(domain, {config.method, config.fluid, sides}));
  PetscCall(catch_together([&] { return fill_state(config, domain, solver); }, reason));
  if (!reason->empty()) PetscFunctionReturn(0);
  PetscCall(shape_profiles(config, domain, solver->rigid(), solver->state().phases, &sides, reason));
  if (!reason->empty()) PetscFunctionReturn(0);
  solver->set_profiles(sides);
  solver->set_adhesion(config.adhesion);
  PetscCall(solver->prepare());
  *reason = solver->stop_reason();
  PetscFunctionReturn(0);
}

}  // namespace eulastic
