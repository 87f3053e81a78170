// The data that all parts of a flow share: grid, method, state, and the memory of a step.
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
  BoundaryConditions sides;
};

struct Flow {
  Flow(const Domain &grid, const SolverSpec &given)
      : domain(grid), spec(given), fluid(spec.fluid), exchange(grid), work(grid) {}
  Flow(const Flow &) = delete;
  Flow &operator=(const Flow &) = delete;

  const Domain &domain;
  SolverSpec spec;
  const Fluid &fluid;  ///< alias of spec.fluid
  GhostExchange exchange;
  WorkSpace work;
  State now;
  BodyTracker bodies;
  /// The velocity that the projection makes solenoidal. After the projection it holds the velocity at the start of the
  /// step, without ghosts.
  Field velocity_star;
  /// Rate of change of the forces per mass, if forces vary linearly within a step (Method::linear_force); else empty.
  Field slope;
  /// If there is a slope: one allocation for State::velocity, slope and velocity_star. Swaps permute their order in it.
  Field memory;
  /// Target fields that are swapped with those of a phase where its transport cannot work in place; else empty.
  Field next_fraction, next_tensor;
  /// Faces of the rigid bodies and their surface velocities within a step; null if the scene has no rigid bodies.
  const RigidFaces *rigid = nullptr;
  RigidMeans *rigid_means = nullptr;
  std::string stop_reason;  ///< one line that says why bodies cannot stay where they are; empty if they can
  std::vector<FlowPart *> parts;

  /// Borrows the memory of slope and velocity_star, which hold nothing between steps.
  Field borrow_idle_memory(int components) {
    return memory.part(velocity_star.data() == memory.data() ? 0 : domain.dimension(), components);
  }
  /// Lists everything that persists from one step to the next, except for the memory of the pressure solver.
  /// Collective.
  PetscErrorCode carry(CarriedState *state);
  /// Bytes of all fields of this rank, those of the parts and the work space included.
  std::size_t bytes() const;
  bool staggered() const { return spec.staggered(); }
  /// Whether phases and pressure are half a step behind the velocity.
  bool phases_lag() const { return staggered() && now.step > 0; }
  /// Whether no wall resists the flow, so that a net force would accelerate all of it without bound.
  bool drifts() const;
  PhaseDomain phase_domain() { return {&domain, &spec.sides, &exchange}; }
  /// The boundaries with the present pressures of those that have loads.
  BoundaryConditions sides_now() const;
  /// Updates ghosts from other ranks and behind boundaries: of a velocity at `time`, and of a field at centres.
  PetscErrorCode update_velocity_ghosts(Field &velocity, double time, int width);
  PetscErrorCode update_centre_ghosts(Field &field, int width);
  /// The fluid with the largest forces per mass that act anywhere: its body force, those of bodies, and the
  /// acceleration that differences between given boundary pressures cause in a fluid at rest.
  Fluid driven_fluid() const;
  /// Velocity scale for tolerances in a step of dt: that of the flow, at least the velocity that the forces generate in
  /// the step, and at least that of the Courant number 1e-6.
  double speed_scale(double dt) const;
  /// Rebuilds everything that follows from the owned cells of a phase (ghosts, occupied rows, B outside the body) after
  /// they have been set.
  PetscErrorCode rebuild_derived_fields(Phase *phase);
  /// Finds the occupied rows of a phase and updates the ghosts of its phi. A phase that fills more than a quarter of
  /// the grid moves to ordinary memory (Field::allocate_fully).
  PetscErrorCode find_rows(Phase *phase);
};

}  // namespace eulastic
