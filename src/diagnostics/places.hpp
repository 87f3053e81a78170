// Positions of extreme values, for messages only.
#pragma once

#include "base/petsc.hpp"
#include "field/field.hpp"
#include "grid/domain.hpp"

namespace eulastic {

/// Centre of the cell with the largest sum |v_d|/h_d on its low faces; the first one if there are several. Collective.
PetscErrorCode place_of_speed(const Domain &domain, const Field &velocity, Real3 *place);
/// Centre of the cell with the largest |div v|; the first one if there are several. Reads one ghost layer. Collective.
PetscErrorCode place_of_divergence(const Domain &domain, const Field &velocity, Real3 *place);
/// Centre of the cell with this index, counted along x, then y, then z.
Real3 place_of_cell(const Box &box, double index);

}  // namespace eulastic
