#include "solids/species_force.hpp"

#include "grid/domain.hpp"
#include "grid/sum_row_parts.hpp"
#include "kernels/isa.hpp"

#include <algorithm>

namespace eulastic {
namespace {

EULASTIC_CLONES void add_row(const Segment &row, double half, const double *phi, std::ptrdiff_t below, double *out) {
#pragma omp simd
  for (int i = row.i_begin; i < row.i_end; ++i) out[i] = kernels::fma(half, phi[i] + phi[i - below], out[i]);
}

// Calls visit(phase, f, component) for every nonzero component of a body force.
template <class Visit>
void for_forces(const Box &box, const std::vector<Phase> &phases, double time, const Visit &visit) {
  for (const Phase &phase : phases) {
    const Real3 force = phase.material.body_force.at(time);
    for (int a = 0; a < box.dimension(); ++a)
      if (force[a] != 0) visit(phase, force[a], a);
  }
}

}  // namespace

bool SpeciesForces::exist(const std::vector<Phase> &phases) {
  return std::any_of(phases.begin(), phases.end(), [](const Phase &phase) { return phase.material.body_force.acts(); });
}

PetscErrorCode SpeciesForces::add_rate(const MomentumRate &rate) {
  const Box &box = flow_.domain;
  Field &out = rate.field;
  PetscFunctionBeginUser;
  for_forces(box, flow_.now.phases, rate.step.force_time, [&](const Phase &phase, double force, int a) {
    const ConstView phi = phase.fraction[0];
    const auto add = [&](const Segment &row) {
      if (!phase.rows.idle(row.j, row.k))
        add_row(row, 0.5 * rate.scale * force, phi.row(row.j, row.k), phi.stride(a), out[a].row(row.j, row.k));
    };
    in_row_parts(box, [&](const RowPart &part) {
      for (const Segment &row : part.rows(box)) add(row);
    });
    for (const Segment &faces : box.open_high_faces(a)) add(faces);
  });
  PetscFunctionReturn(0);
}

PetscErrorCode SpeciesForces::add_power(const SynchronisedBodies &bodies, double *power) {
  const Domain &domain = flow_.domain;
  const Field &velocity = flow_.now.velocity;
  double total = 0;
  PetscFunctionBeginUser;
  const auto add = [&](const RowPart &part, ExactSums &sum) {
    std::vector<double> values(domain.cells()[0]);
    for_forces(domain, bodies.phases, flow_.now.time, [&](const Phase &phase, double force, int a) {
      const std::ptrdiff_t below = phase.fraction[0].stride(a);
      for (const Segment &row : part.rows(domain)) {
        if (phase.rows.idle(row.j, row.k)) continue;
        const double *phi = phase.fraction[0].row(row.j, row.k), *v = velocity[a].row(row.j, row.k);
        for (int i = 0; i < row.size(); ++i) values[i] = 0.5 * force * (phi[i] + phi[i - below]) * v[i];
        sum.add_row(0, values.data(), row.size(), domain.layout().begin[0]);
      }
    });
  };
  PetscCall(sum_row_parts(domain, 1, add, &total));
  *power += total * flow_.fluid.density * domain.cell_volume();
  PetscFunctionReturn(0);
}

}  // namespace eulastic
