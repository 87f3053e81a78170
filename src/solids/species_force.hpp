// A force per mass on the bodies of a species alone: phi f, phi averaged to faces. Bodies keep the density of the fluid
// as far as inertia goes: settling, a centrifuge, a magnetic pull.
#pragma once

#include "base/petsc.hpp"
#include "field/phase.hpp"
#include "grid/domain.hpp"

namespace eulastic {

/// Whether any phase has one.
bool species_are_forced(const std::vector<Phase> &phases);
/// out += scale phi f(time) at owned faces; one ghost of phi.
void add_species_forces(const Box &box, const std::vector<Phase> &phases, double time, double scale, Field &out);
/// What they do on the flow: sum of density phi f . v. Collective.
PetscErrorCode species_force_power(const Domain &domain, const std::vector<Phase> &phases, double time, double density,
                                   const Field &velocity, double *power);

}  // namespace eulastic
