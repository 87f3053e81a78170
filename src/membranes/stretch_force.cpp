#include "membranes/stretch_force.hpp"

#include "base/exact_sum.hpp"
#include "bodies/body_sums.hpp"
#include "bodies/unwrap.hpp"

#include <algorithm>

namespace eulastic {
bool StretchForces::exist(const std::vector<Phase> &phases) {
  return std::any_of(phases.begin(), phases.end(),
                     [](const Phase &phase) { return !phase.boxed && phase.material.stretch_force.force > 0; });
}

// visit(phase, slot of the body, column, i, j, k) for owned cells of bodies that are pulled.
template <class Visit>
void StretchForces::for_cells(const std::vector<Phase> &phases, const Visit &visit) const {
  for (const Phase &phase : phases) {
    if (!(phase.material.stretch_force.force > 0) || !phase.label) continue;
    const ConstView label = phase.label[0];
    for (const Segment &whole : domain_->rows()) {
      const Segment row = phase.rows.within(whole, label);
      for (int i = row.i_begin; i < row.i_end; ++i) {
        const int b = owners_->slot(static_cast<int>(label(i, row.j, row.k)) - 1);
        if (b < 0) continue;
        const int low = domain_->is_wall(0) ? -near_[b][0] : -(domain_->domain_cells()[0] / 2);  // of offset()
        visit(phase, b, static_cast<int>(offset(*domain_, near_[b], {i, row.j, row.k})[0]) - low, i, row.j, row.k);
      }
    }
  }
}

PetscErrorCode StretchForces::find(const Domain &domain, const std::vector<Phase> &phases, const BodyOwners &owners,
                                   const std::vector<Int3> &references) {
  PetscFunctionBeginUser;
  domain_ = &domain;
  owners_ = &owners;
  near_ = references;
  const int columns = domain.domain_cells()[0];
  BodySums sums(near_.size(), columns);
  std::vector<StretchForce> forces(near_.size());
  std::vector<double> owned, volumes(near_.size() * columns);
  for_cells(phases, [&](const Phase &phase, int body, int column, int i, int j, int k) {
    sums.add(body, column, phase.fraction[0](i, j, k));
    forces[body] = phase.material.stretch_force;
  });
  PetscCall(sums.reduce(owners));
  for (int b = 0; b < owners.owned().size(); ++b)
    for (int c = 0; c < columns; ++c) owned.push_back(sums.value(b, c) * domain.cell_volume());
  PetscCall(owners.bring(columns, owned, &volumes));
  pull_.assign(near_.size(), {});
  for (std::size_t b = 0; b < near_.size(); ++b) {
    if (forces[b].force == 0) continue;
    const auto first = volumes.begin() + static_cast<std::ptrdiff_t>(b * columns);
    pull_[b] = forces[b].per_volume({first, first + columns});
  }
  PetscFunctionReturn(0);
}

PetscErrorCode StretchForces::add(GhostExchange &exchange, const std::vector<Phase> &phases, Field &scratch,
                                  const std::vector<WeightedTarget> &targets) const {
  PetscFunctionBeginUser;
  scratch.fill(0, 0);
  const View force = scratch[0];
  for_cells(phases, [&](const Phase &phase, int body, int column, int i, int j, int k) {
    force(i, j, k) += pull_[body][column] * phase.fraction[0](i, j, k);
  });
  PetscCall(exchange.update_ghosts(scratch, 1));
  for (const auto &[field, factor] : targets)
    for (const Segment &row : domain_->rows()) {
      const double *f = force.row(row.j, row.k);
      double *out = (*field)[0].row(row.j, row.k);
      for (int i = row.i_begin; i < row.i_end; ++i) out[i] += 0.5 * factor * (f[i - 1] + f[i]);
    }
  PetscFunctionReturn(0);
}

PetscErrorCode StretchForces::power(const std::vector<Phase> &phases, const Field &velocity, double *power) const {
  PetscFunctionBeginUser;
  ExactSums sum(1);
  const ConstView v = velocity[0];
  for_cells(phases, [&](const Phase &phase, int body, int column, int i, int j, int k) {
    const double force = pull_[body][column] * phase.fraction[0](i, j, k);
    sum.add(0, 0.5 * force * (v(i, j, k) + v(i + 1, j, k)));
  });
  PetscCall(sum.reduce(domain_->comm(), power));
  *power *= domain_->cell_volume();
  PetscFunctionReturn(0);
}

}  // namespace eulastic
