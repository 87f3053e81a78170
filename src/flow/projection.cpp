#include "flow/projection.hpp"

#include "base/events.hpp"
#include "field/open_boundaries.hpp"
#include "flow/correction.hpp"
#include "flow/momentum.hpp"
#include "flow/viscous_stress.hpp"
#include "grid/threads.hpp"
#include "kernels/momentum.hpp"
#include "parts/flow_part.hpp"
#include "pressure/acm.hpp"
#include "pressure/acm_iterations.hpp"
#include "pressure/ksp.hpp"
#include "pressure/obstacles.hpp"
#include "pressure/smac.hpp"
#include "rigid/rigid_surfaces.hpp"

#include <algorithm>
#include <cmath>

namespace eulastic {
namespace {

template <int Dim>
EULASTIC_INLINE void divergence_rows(const Box &box, const RowPart &part, double density, const Field &v, Field &out) {
  const Real3 &h = box.spacing();
  const double inverse[3] = {1 / h[0], 1 / h[1], 1 / h[2]};
  for (const Segment &s : part.rows(box))
    kernels::divergence<Dim>(s, v[0], v[1], v[Dim - 1], inverse, density, out[0].row(s.j, s.k));
}

EULASTIC_CLONES void divergence_2d(const Box &box, const RowPart &part, double density, const Field &v, Field &out) {
  divergence_rows<2>(box, part, density, v, out);
}
EULASTIC_CLONES void divergence_3d(const Box &box, const RowPart &part, double density, const Field &v, Field &out) {
  divergence_rows<3>(box, part, density, v, out);
}

}  // namespace

PetscErrorCode compute_divergence(const Box &box, double density, const Field &velocity_star, Field &divergence) {
  PetscFunctionBeginUser;
  EventScope scope(Event::divergence);
  in_row_parts(box, [&](const RowPart &part) {
    (box.dimension() == 2 ? divergence_2d : divergence_3d)(box, part, density, velocity_star, divergence);
  });
  scope.flops(box.cell_count() * (3 * box.dimension() - 1));
  PetscFunctionReturn(0);
}

int Projection::work_fields(const Method &method, bool open, bool rigid) {
  const bool sweeps = method.pressure == PressureKind::acm && !method.is_single_acm_step();
  const bool formula = method.pressure == PressureKind::acm && !sweeps && !open;
  return 1 + !formula + (sweeps ? AcmIterativeSolver::work_fields : 0) +
         (rigid && !method.is_single_acm_step() ? ObstacleSolver::work_fields : 0);
}

// With rigid bodies their solver remembers the increments, not that which preconditions it.
double Projection::fields(const Method &method, int dimension, bool rigid) {
  if (method.pressure == PressureKind::acm && method.is_single_acm_step()) return 0;
  const double remembered = rigid ? method.acm_memory : 0;
  if (method.pressure == PressureKind::smac) return SmacSolver::fields + remembered;
  if (method.pressure == PressureKind::ksp) return KspSolver::fields + remembered;
  return AcmIterativeSolver::fields({method.acm_sweeps_max, rigid ? 0 : method.acm_memory, method.acm_coarse},
                                    dimension) +
         remembered;
}

PetscErrorCode Projection::create(int memory) {
  const SolverSpec &spec = flow_.spec;
  PetscFunctionBeginUser;
  if (spec.pressure == PressureKind::smac) {
    PetscCall(SmacSolver::create(flow_.domain, flow_.exchange, &solver_));
  } else if (spec.pressure == PressureKind::ksp) {
    auto ksp = std::make_unique<KspSolver>();
    PetscCall(ksp->create(flow_.domain, flow_.exchange));
    solver_ = std::move(ksp);
  } else if (spec.is_single_acm_step()) {
    solver_ = std::make_unique<AcmSolver>(flow_.domain);
  } else {
    auto sweeps = std::make_unique<AcmIterativeSolver>();
    PetscCall(sweeps->create(flow_.domain, flow_.exchange, {spec.acm_sweeps_max, memory, spec.acm_coarse}, flow_.work));
    solver_ = std::move(sweeps);
  }
  PetscFunctionReturn(0);
}

// Solves (10) or (11) for a velocity with one valid ghost layer.
PetscErrorCode Projection::find_increment(double dt, double target, const Field &velocity, Field &pressure,
                                          Field &divergence, Field &increment) {
  PetscFunctionBeginUser;
  PetscCall(compute_divergence(flow_.domain, flow_.fluid.density, velocity, divergence));
  PetscCall(flow_.exchange.update_ghosts(divergence, 1));
  fill_ghosts_of_increment(flow_.domain, divergence[0], 1);
  solver_->set_target(target);
  PetscCall(solver_->solve(dt, divergence, pressure, increment));
  PetscFunctionReturn(0);
}

PetscErrorCode Projection::correct(double dt, double rotation, const Field &divergence, const Field &increment,
                                   Field &velocity, Field &pressure) {
  const double density = flow_.fluid.density;
  PetscFunctionBeginUser;
  if (const kernels::AcmIncrement *formula = solver_->formula())
    PetscCall(correct_velocity(flow_.domain, density, dt, rotation, *formula, divergence, velocity, pressure));
  else
    PetscCall(correct_velocity(flow_.domain, density, dt, rotation, increment, divergence, velocity, pressure));
  PetscFunctionReturn(0);
}

PetscErrorCode Projection::end_step(double dt, const RotationalUpdate &rotation, const Field &viscosity) {
  const Real3 &h = flow_.domain.spacing();
  const double shortest = flow_.domain.dimension() == 3 ? std::min({h[0], h[1], h[2]}) : std::min(h[0], h[1]);
  const double target = flow_.spec.acm_tolerance * flow_.fluid.density * flow_.speed_scale(dt) / shortest;
  WorkSpace::Lease divergence_lease, increment;
  PetscFunctionBeginUser;
  PetscCall(flow_.work.lease("divergence", 1, &divergence_lease));
  if (!solver_->formula()) PetscCall(flow_.work.lease("pressure increment", 1, &increment));
  Field &divergence = divergence_lease.fields(), &pressure = flow_.now.pressure, &velocity = flow_.velocity_star;
  PetscCall(find_increment(dt, target, velocity, pressure, divergence, increment.fields()));
  for (FlowPart *part : flow_.parts) {
    PetscCall(part->begin_correction(divergence));
    if (!solver_->formula()) PetscCall(part->observe_increment(increment.fields()));
  }
  PetscCall(correct(dt, rotation.uniform, divergence, increment.fields(), velocity, pressure));
  for (FlowPart *part : flow_.parts) PetscCall(part->correct(flow_.now.time + dt, dt, increment.fields(), velocity));
  for (FlowPart *part : flow_.parts) PetscCall(part->end_projection(dt, divergence, increment.fields()));
  if (rotation.local > 0)
    PetscCall(apply_rotational_update(flow_.domain, viscosity, rotation.local, divergence, pressure));
  flow_.now.velocity.swap(velocity);
  PetscFunctionReturn(0);
}

// The paper's single step of artificial compressibility is repeated until the velocity is nearly solenoidal.
PetscErrorCode Projection::make_solenoidal(bool is_rate, Field &velocity, Field &pressure) {
  constexpr double dt = 1;
  const int iterations = flow_.spec.pressure == PressureKind::acm && flow_.spec.is_single_acm_step() ? 200 : 1;
  WorkSpace::Lease divergence_lease, increment;
  Field pressure_correction(flow_.domain, 1);  // starts at 0, so that (11) has no relaxation
  PetscFunctionBeginUser;
  PetscCall(flow_.work.lease("divergence", 1, &divergence_lease));
  if (!solver_->formula()) PetscCall(flow_.work.lease("pressure increment", 1, &increment));
  Field &divergence = divergence_lease.fields();
  for (int n = 0; n < iterations; ++n) {
    PetscCall(flow_.exchange.update_ghosts(velocity, 1));
    PetscCall(find_increment(dt, 0, velocity, pressure_correction, divergence, increment.fields()));
    PetscCall(correct(dt, 0, divergence, increment.fields(), velocity, pressure_correction));
    for (FlowPart *part : flow_.parts) PetscCall(part->correct(flow_.now.time, dt, increment.fields(), velocity));
    if (flow_.rigid && is_rate) clear_rigid_faces(flow_.domain, *flow_.rigid, velocity);
    for (const Segment &row : flow_.domain.rows()) {
      const double *q = pressure_correction[0].row(row.j, row.k);
      double *p = pressure[0].row(row.j, row.k);
      for (int i = 0; i < row.i_end; ++i) p[i] += q[i];
    }
    pressure_correction.clear();
  }
  PetscFunctionReturn(0);
}

namespace {

// Returns boundary conditions whose given velocities are the time derivatives of those of `sides`.
BoundaryConditions time_derivatives_of(const BoundaryConditions &sides, double time) {
  BoundaryConditions rates = sides;
  for (auto &pair : rates)
    // inlet generators have no velocity yet at the start
    for (BoundaryCondition &side : pair) side.given = {side.given.rate(time), 0, 0, {}};
  return rates;
}

}  // namespace

// The first step would also do this, but with a pressure that grows as 1/dt, which the next step would start from.
PetscErrorCode start_flow(Flow *flow, Projection *projection) {
  const Domain &domain = flow->domain;
  State &now = flow->now;
  const int dim = domain.dimension();
  double largest = 0;
  Field unused(domain, 1), rate(domain, dim), no_advection;
  PetscFunctionBeginUser;
  PetscCall(projection->make_solenoidal(false, now.velocity, unused));
  PetscCall(flow->update_velocity_ghosts(now.velocity, now.time, Box::stencil_width));
  for_points(domain.rows(),
             [&](int i, int j, int k) { largest = std::max(largest, std::fabs(now.pressure[0](i, j, k))); });
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &largest, 1, MPI_DOUBLE, MPI_MAX, domain.comm()));
  if (largest > 0) PetscFunctionReturn(0);  // the pressure was read from a file
  fill_ghosts_of_given_pressure(domain, flow->spec.sides, now.time, flow->fluid.inertial_density(), now.velocity,
                                now.pressure[0]);
  const MomentumStep step{now.time, 1, flow->speed_scale(1), {}};
  PetscCall(momentum_rate(domain, flow->fluid, step, now.velocity, now.pressure, {}, no_advection, rate));
  for (int d = 0; d < dim; ++d)
    if (domain.is_wall(d)) {
      close_wall_faces(domain, rate[d], d);
      set_inflow_faces(domain, time_derivatives_of(flow->spec.sides, now.time), 0, rate[d], d);
    }
  const double nu = flow->fluid.kinematic_viscosity();
  if (flow->rigid) apply_rigid_surfaces(domain, *flow->rigid, nu, nu, now.time, 0, now.velocity, rate, nullptr);
  PetscCall(projection->make_solenoidal(true, rate, now.pressure));
  PetscCall(flow->update_centre_ghosts(now.pressure, 1));
  PetscFunctionReturn(0);
}

}  // namespace eulastic
