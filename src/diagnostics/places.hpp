// Where in the box something is at its worst: for messages, never in the time step.
#pragma once

#include "base/petsc.hpp"
#include "field/field.hpp"
#include "grid/domain.hpp"

namespace eulastic {

/// Collective. Centre of the cell with the largest sum |v_d|/h_d on its low faces; of several the first.
PetscErrorCode place_of_speed(const Domain &domain, const Field &velocity, Real3 *place);
/// Collective. Centre of the cell with the largest |div v|; of several the first. One ghost layer valid.
PetscErrorCode place_of_divergence(const Domain &domain, const Field &velocity, Real3 *place);
/// Centre of the cell with that index, counted along x, then y, then z.
Real3 place_of_cell(const Box &box, double index);

}  // namespace eulastic
