// One time step of the method, as verbs in its order. No printing, no rank tests, no options.
#pragma once

#include "bodies/measures.hpp"
#include "field/ghost_exchange.hpp"
#include "physics/fluid.hpp"
#include "physics/limits.hpp"
#include "pressure/pressure_solver.hpp"
#include "solver/state.hpp"

#include <memory>

namespace eulastic {

enum class PressureKind { acm, smac };

struct SolverSpec {
  Fluid fluid;
  Walls walls;
  PressureKind pressure = PressureKind::acm;
};

class Solver {
public:
  /// Allocates velocity and pressure on `grid` (all zero) and the work space of the method.
  PetscErrorCode create(const Grid &grid, const SolverSpec &spec);

  const Grid &grid() const { return *grid_; }
  const SolverSpec &spec() const { return spec_; }
  GhostExchange &exchange() { return *exchange_; }
  State &state() { return now_; }
  BodyTracker &bodies() { return bodies_; }
  const State &state() const { return now_; }

  /// Makes ghosts, B outside the bodies and active segments consistent; call after the initial fields are set.
  PetscErrorCode prepare();
  /// Measures the flow: time step limits, WENO5's velocity scale.
  PetscErrorCode measure(FlowExtremes *extremes);
  TimeStepLimits limits(const FlowExtremes &extremes) const;
  /// Bytes of all fields of this rank, work space included.
  std::size_t bytes() const;
  /// Advances by dt with `-method classic`.
  PetscErrorCode step(double dt);

private:
  PetscErrorCode update_velocity_ghosts(FieldBlock &velocity, double time, int width);
  PetscErrorCode update_centre_ghosts(FieldBlock &field, int width);
  PetscErrorCode update_tensor_ghosts(FieldBlock &tensor, int width);
  double speed_scale(double dt) const;
  PetscErrorCode project(double dt);
  PetscErrorCode transport(Phase &phase, double dt);
  PetscErrorCode follow_bodies(double dt);

  const Grid *grid_ = nullptr;
  SolverSpec spec_;
  std::unique_ptr<GhostExchange> exchange_;
  std::unique_ptr<PressureSolver> pressure_solver_;
  State now_;
  BodyTracker bodies_;
  FieldBlock velocity_star_, divergence_, increment_, next_fraction_, next_tensor_;
};

}  // namespace eulastic
