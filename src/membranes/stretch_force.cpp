#include "membranes/stretch_force.hpp"

#include "bodies/body_sums.hpp"
#include "bodies/unwrap.hpp"

#include <algorithm>
#include <utility>

namespace eulastic {

StretchedBody::StretchedBody(const Box &box, const Phase &phase) : box_(&box), phase_(&phase) {
  std::vector<double> volumes(box.cells()[0], 0.0);
  const ConstView phi = phase.fraction[0];
  for (const Segment &whole : box.rows()) {
    const Segment row = phase.rows.within(whole);
    for (int i = row.i_begin; i < row.i_end; ++i) volumes[i] += phi(i, row.j, row.k) * box.cell_volume();
  }
  per_volume_ = phase.material.stretch_force.per_volume(volumes);
}

void StretchedBody::add_force(View force) const {
  const ConstView phi = phase_->fraction[0];
  const int n = box_->cells()[0];
  for (const Segment &whole : box_->rows()) {
    const Segment row = phase_->rows.within(whole);
    for (int i = row.i_begin; i < row.i_end; ++i) {
      const double half = 0.5 * per_volume_[i] * phi(i, row.j, row.k);
      force(i, row.j, row.k) += half;
      if (i + 1 < n) force(i + 1, row.j, row.k) += half;
    }
  }
}

void StretchedBody::add_power(ConstView velocity, int which, ExactSums *sum) const {
  const ConstView phi = phase_->fraction[0];
  for (const Segment &whole : box_->rows()) {
    const Segment row = phase_->rows.within(whole);
    for (int i = row.i_begin; i < row.i_end; ++i) {
      const double force = per_volume_[i] * phi(i, row.j, row.k);
      if (force != 0) sum->add(which, 0.5 * force * (velocity(i, row.j, row.k) + velocity(i + 1, row.j, row.k)));
    }
  }
}

bool StretchForces::exist(const std::vector<Phase> &phases) {
  return std::any_of(phases.begin(), phases.end(),
                     [](const Phase &phase) { return !phase.boxed && phase.material.stretch_force.force > 0; });
}

// Calls visit(phase, slot of the body, column, i, j, k) for owned cells of bodies that are stretched.
template <class Visit>
void StretchForces::for_cells(const std::vector<Phase> &phases, const Visit &visit) const {
  for (const Phase &phase : phases) {
    if (!(phase.material.stretch_force.force > 0) || !phase.label) continue;
    const ConstView label = phase.label[0];
    for (const Segment &whole : flow_.domain.rows()) {
      const Segment row = phase.rows.within(whole, label);
      for (int i = row.i_begin; i < row.i_end; ++i) {
        const int b = owners_->slot(static_cast<int>(label(i, row.j, row.k)) - 1);
        if (b < 0) continue;
        // Smallest offset().
        const int low = flow_.domain.is_wall(0) ? -near_[b][0] : -(flow_.domain.domain_cells()[0] / 2);
        visit(phase, b, static_cast<int>(offset(flow_.domain, near_[b], {i, row.j, row.k})[0]) - low, i, row.j, row.k);
      }
    }
  }
}

PetscErrorCode StretchForces::find(const std::vector<Phase> &phases) {
  const Domain &domain = flow_.domain;
  PetscFunctionBeginUser;
  owners_ = std::make_unique<BodyOwners>();
  PetscCall(flow_.bodies.connect(domain, phases, {}, owners_.get(), &near_));
  const int columns = domain.domain_cells()[0];
  BodySums sums(near_.size(), columns);
  std::vector<StretchForce> forces(near_.size());
  std::vector<double> owned, volumes(near_.size() * columns);
  for_cells(phases, [&](const Phase &phase, int body, int column, int i, int j, int k) {
    sums.add(body, column, phase.fraction[0](i, j, k));
    forces[body] = phase.material.stretch_force;
  });
  PetscCall(sums.reduce(*owners_));
  for (int b = 0; b < owners_->owned().size(); ++b)
    for (int c = 0; c < columns; ++c) owned.push_back(sums.value(b, c) * domain.cell_volume());
  PetscCall(owners_->bring(columns, owned, &volumes));
  pull_.assign(near_.size(), {});
  for (std::size_t b = 0; b < near_.size(); ++b) {
    if (forces[b].force == 0) continue;
    const auto first = volumes.begin() + static_cast<std::ptrdiff_t>(b * columns);
    pull_[b] = forces[b].per_volume({first, first + columns});
  }
  PetscFunctionReturn(0);
}

PetscErrorCode StretchForces::begin_slope(double dt, Field &slope) {
  return add({{&slope, -1 / (dt * flow_.fluid.density)}});
}

PetscErrorCode StretchForces::add_rate(const MomentumRate &rate) {
  const double density = flow_.fluid.density;
  std::vector<WeightedTarget> targets{{&rate.field, rate.scale / density}};
  if (rate.slope.field) targets.push_back({rate.slope.field, rate.slope.factor / density});
  return add(targets);
}

// Uses the phases of the state, with labels and references of the last step.
PetscErrorCode StretchForces::add(const std::vector<WeightedTarget> &targets) {
  const std::vector<Phase> &phases = flow_.now.phases;
  WorkSpace::Lease lease;
  PetscFunctionBeginUser;
  PetscCall(find(phases));
  PetscCall(flow_.work.lease("stretch force", 1, &lease));
  Field &scratch = lease.fields();
  scratch.fill(0, 0);
  const View force = scratch[0];
  for_cells(phases, [&](const Phase &phase, int body, int column, int i, int j, int k) {
    force(i, j, k) += pull_[body][column] * phase.fraction[0](i, j, k);
  });
  PetscCall(flow_.exchange.update_ghosts(scratch, 1));
  for (const auto &[field, factor] : targets)
    for (const Segment &row : flow_.domain.rows()) {
      const double *f = force.row(row.j, row.k);
      double *out = (*field)[0].row(row.j, row.k);
      for (int i = row.i_begin; i < row.i_end; ++i) out[i] += 0.5 * factor * (f[i - 1] + f[i]);
    }
  PetscFunctionReturn(0);
}

PetscErrorCode StretchForces::add_power(const SynchronisedBodies &bodies, double *power) {
  double total = 0;
  PetscFunctionBeginUser;
  PetscCall(find(bodies.phases));
  ExactSums sum(1);
  const ConstView v = std::as_const(flow_.now.velocity)[0];
  for_cells(bodies.phases, [&](const Phase &phase, int body, int column, int i, int j, int k) {
    const double force = pull_[body][column] * phase.fraction[0](i, j, k);
    sum.add(0, 0.5 * force * (v(i, j, k) + v(i + 1, j, k)));
  });
  PetscCall(sum.reduce(flow_.domain.comm(), &total));
  *power += total * flow_.domain.cell_volume();
  PetscFunctionReturn(0);
}

}  // namespace eulastic
