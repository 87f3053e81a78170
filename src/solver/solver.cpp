#include "solver/solver.hpp"

#include "bodies/labels.hpp"
#include "physics/momentum.hpp"
#include "physics/transport.hpp"
#include "pressure/acm.hpp"
#include "pressure/smac.hpp"

#include <algorithm>
#include <cmath>

namespace eulastic {

PetscErrorCode Solver::create(const Grid &grid, const SolverSpec &spec) {
  PetscFunctionBeginUser;
  grid_ = &grid;
  spec_ = spec;
  exchange_ = std::make_unique<GhostExchange>(grid);
  if (spec.pressure == PressureKind::smac)
    PetscCall(SmacSolver::create(grid, *exchange_, &pressure_solver_));
  else
    pressure_solver_ = std::make_unique<AcmSolver>(grid);
  now_.velocity = FieldBlock(grid, grid.dimension());
  now_.pressure = FieldBlock(grid, 1);
  velocity_star_ = FieldBlock(grid, grid.dimension());
  divergence_ = FieldBlock(grid, 1);
  increment_ = FieldBlock(grid, 1);
  PetscFunctionReturn(0);
}

PetscErrorCode Solver::prepare() {
  PetscFunctionBeginUser;
  PetscCall(update_velocity_ghosts(now_.velocity, now_.time, Grid::stencil_width));
  PetscCall(update_centre_ghosts(now_.pressure, 1));
  for (Phase &phase : now_.phases) {
    PetscCall(update_centre_ghosts(phase.fraction, Grid::stencil_width));
    PetscCall(reset_exterior(*grid_, phase));
    PetscCall(find_solid(*grid_, phase));
    PetscCall(update_tensor_ghosts(phase.tensor, Grid::stencil_width));
  }
  if (!now_.phases.empty()) {
    next_fraction_ = FieldBlock(*grid_, 1);
    next_tensor_ = FieldBlock(*grid_, now_.phases[0].tensor.count());
  }
  PetscFunctionReturn(0);
}

PetscErrorCode Solver::measure(FlowExtremes *extremes) {
  PetscFunctionBeginUser;
  PetscCall(measure_extremes(*grid_, now_.velocity, now_.phases, extremes));
  double scale = extremes->max_speed();
  for (const auto &pair : spec_.walls.motion)
    for (const WallMotion &wall : pair) scale = std::max(scale, wall.speed());
  now_.speed_scale = scale;
  now_.crossing_rate = 0;
  for (int d = 0; d < grid_->dimension(); ++d)
    now_.crossing_rate = std::max(now_.crossing_rate, extremes->speed[d] / grid_->spacing()[d]);
  PetscFunctionReturn(0);
}

TimeStepLimits Solver::limits(const FlowExtremes &extremes) const {
  double modulus = 0;
  for (const Phase &phase : now_.phases) modulus = std::max(modulus, phase.material.shear_modulus);
  return euler_limits(*grid_, spec_.fluid, modulus, extremes);
}

std::size_t Solver::bytes() const {
  std::size_t sum = now_.velocity.bytes() + now_.pressure.bytes() + velocity_star_.bytes() + divergence_.bytes() +
                    increment_.bytes() + next_fraction_.bytes() + next_tensor_.bytes();
  for (const Phase &phase : now_.phases) sum += phase.fraction.bytes() + phase.tensor.bytes() + phase.label.bytes();
  return sum;
}

PetscErrorCode Solver::step(double dt) {
  PetscFunctionBeginUser;
  PetscCall(predict_velocity(*grid_, spec_.fluid, now_.time, dt, speed_scale(dt), now_.velocity, now_.pressure,
                             now_.phases, velocity_star_));                                           // (7)
  PetscCall(update_velocity_ghosts(velocity_star_, now_.time + dt, 1));
  PetscCall(project(dt));                                                                             // (8)-(13)
  PetscCall(update_velocity_ghosts(now_.velocity, now_.time + dt, Grid::stencil_width));
  for (Phase &phase : now_.phases) PetscCall(transport(phase, dt));                                   // (4)(5)
  PetscCall(follow_bodies(dt));
  now_.time += dt;
  now_.dt = dt;
  ++now_.step;
  PetscFunctionReturn(0);
}

// At rest: what the force makes in a step, and never less than a Courant number of 1e-6.
double Solver::speed_scale(double dt) const {
  const Real3 &f = spec_.fluid.body_force.force, &h = grid_->spacing();
  return std::max({now_.speed_scale, dt * std::hypot(f[0], f[1], f[2]), 1e-6 * std::min(h[0], h[1]) / dt});
}

PetscErrorCode Solver::project(double dt) {
  PetscFunctionBeginUser;
  const double density = spec_.fluid.density;
  PetscCall(compute_divergence(*grid_, density, velocity_star_, divergence_));
  PetscCall(update_centre_ghosts(divergence_, 1));
  PetscCall(pressure_solver_->solve(dt, divergence_, now_.pressure, increment_));                     // (10) or (11)
  PetscCall(correct_velocity(*grid_, density, dt, increment_, velocity_star_, now_.velocity, now_.pressure));
  PetscFunctionReturn(0);
}

// B follows the new velocity: forward Euler in both would need dt <= mu/G.
PetscErrorCode Solver::transport(Phase &phase, double dt) {
  PetscFunctionBeginUser;
  PetscCall(advect_fraction(*grid_, dt, now_.velocity, phase.fraction, next_fraction_));              // (4)
  phase.fraction.swap(next_fraction_);
  PetscCall(update_centre_ghosts(phase.fraction, Grid::stencil_width));
  PetscCall(find_solid(*grid_, phase));
  PetscCall(transport_tensor(*grid_, dt, now_.velocity, phase, next_tensor_));                        // (5)
  phase.tensor.swap(next_tensor_);
  PetscCall(update_tensor_ghosts(phase.tensor, Grid::stencil_width));
  PetscFunctionReturn(0);
}

// Labels are carried on a schedule that is part of the run, never because somebody looks.
PetscErrorCode Solver::follow_bodies(double dt) {
  constexpr double allowed = 0.3;  // cells; below the half that carry_labels() bears, as the speed is some steps old
  PetscFunctionBeginUser;
  now_.travel += now_.crossing_rate * dt;
  if (bodies_.bodies() == 0 || now_.travel < allowed) PetscFunctionReturn(0);
  for (Phase &phase : now_.phases) PetscCall(carry_labels(*grid_, *exchange_, &phase));
  PetscCall(bodies_.follow(*grid_, now_.phases));
  now_.travel = 0;
  PetscFunctionReturn(0);
}

PetscErrorCode Solver::update_velocity_ghosts(FieldBlock &velocity, double time, int width) {
  PetscFunctionBeginUser;
  PetscCall(exchange_->update(velocity, width));
  fill_wall_ghosts_velocity(*grid_, spec_.walls, time, velocity, width);
  PetscFunctionReturn(0);
}

PetscErrorCode Solver::update_centre_ghosts(FieldBlock &field, int width) {
  PetscFunctionBeginUser;
  PetscCall(exchange_->update(field, width));
  fill_wall_ghosts_even(*grid_, at_centre, field[0], width);
  PetscFunctionReturn(0);
}

PetscErrorCode Solver::update_tensor_ghosts(FieldBlock &tensor, int width) {
  PetscFunctionBeginUser;
  PetscCall(exchange_->update(tensor, width));
  fill_wall_ghosts_tensor(*grid_, tensor, width);
  PetscFunctionReturn(0);
}

}  // namespace eulastic
