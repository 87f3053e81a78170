// What all parts of a flow share: the grid, the scheme, the state and the memory that a step works in.
#pragma once

#include "base/petsc.hpp"
#include "bodies/measures.hpp"
#include "field/ghost_exchange.hpp"
#include "field/material.hpp"
#include "field/phase.hpp"
#include "field/rigid_faces.hpp"
#include "field/work_space.hpp"
#include "grid/domain.hpp"
#include "parts/method.hpp"
#include "parts/state.hpp"

#include <string>
#include <vector>

namespace eulastic {

struct CarriedState;
class FlowPart;
struct RigidMeans;

struct SolverSpec : Method {
  Fluid fluid;
  BoxSides sides;
};

struct Flow {
  Flow(const Domain &grid, const SolverSpec &given)
      : domain(grid), spec(given), fluid(spec.fluid), exchange(grid), work(grid) {}
  Flow(const Flow &) = delete;
  Flow &operator=(const Flow &) = delete;

  const Domain &domain;
  SolverSpec spec;
  const Fluid &fluid;  ///< of the spec
  GhostExchange exchange;
  WorkSpace work;
  State now;
  BodyTracker bodies;
  /// The velocity that the projection makes solenoidal; after it that of the start of the step, without ghosts.
  Field velocity_star;
  /// How forces per mass change in time, where that is followed within a step (Method::linear_force); else empty.
  Field slope;
  /// With a slope: the memory of this velocity, of the slope and of velocity_star, whichever comes first and last.
  Field memory;
  /// What the fields of a phase are swapped with where its transport is not done in place; else empty.
  Field next_fraction, next_tensor;
  /// What the rigid bodies of the scene are to the flow, and what they see within a step; null: there are none.
  const RigidFaces *rigid = nullptr;
  RigidMeans *rigid_means = nullptr;
  std::string crowded;  ///< one line if bodies are where they cannot stay
  std::vector<FlowPart *> parts;

  /// Memory of the slope and of velocity_star, which are idle between steps.
  Field idle_memory(int components) {
    return memory.part(velocity_star.data() == memory.data() ? 0 : domain.dimension(), components);
  }
  /// All that is carried from one step to the next, but for the pressure solver's memory. Collective.
  PetscErrorCode carry(CarriedState *state);
  std::size_t bytes() const;
  bool staggered() const { return spec.staggered(); }
  /// Whether the phases live half a step behind the velocity.
  bool is_behind() const { return staggered() && now.step > 0; }
  /// Whether no wall holds the fluid, so that a net force would move all of it for ever.
  bool drifts() const;
  PhasePlace place_of_phases() { return {&domain, &spec.sides, &exchange}; }
  /// The sides with the pressures that those with loads have now.
  BoxSides sides_now() const;
  /// Ghosts from other ranks and behind sides, of a velocity of `time` and of a field at centres.
  PetscErrorCode update_velocity_ghosts(Field &velocity, double time, int width);
  PetscErrorCode update_centre_ghosts(Field &field, int width);
  /// The fluid, driven by the largest forces that act anywhere in the box: that of its own, those of bodies, and what
  /// differences of given pressures are to a fluid at rest.
  Fluid driven_fluid() const;
  /// A velocity for tolerances in a step of dt: that of the flow; at rest what the force makes in a step, and never
  /// less than a Courant number of 1e-6.
  double speed_scale(double dt) const;
  /// Makes ghosts, rows and B outside the body consistent after owned cells of a phase have been set.
  PetscErrorCode settle(Phase *phase);
  /// The same of phi alone, and rows where there is nothing are left at rest. A phase that fills much of the grid has
  /// nothing to rest from.
  PetscErrorCode find_rows(Phase *phase);
};

}  // namespace eulastic
