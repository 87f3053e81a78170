// Velocity, pressure and solid fraction at points, interpolated linearly from their positions on the grid, and means
// over planes of cells. The bits do not depend on the number of ranks.
#pragma once

#include "base/petsc.hpp"
#include "field/phase.hpp"
#include "grid/domain.hpp"

namespace eulastic {

struct Sample {
  Real3 velocity{};
  double pressure = 0;
  double solid_fraction = 0;  ///< of all phases, at most 1
};

/// The fields to sample, with one valid ghost layer; phases are at the time of the velocity.
struct SampledFields {
  const Field &velocity, &pressure;
  const std::vector<Phase> &phases;
};

/// Samples `points` of the box; z is ignored in 2-D. Of second order; between a wall and the first centre the pressure
/// is extrapolated, and the solid fraction is constant. One Allreduce.
PetscErrorCode sample_points(const Domain &domain, const SampledFields &fields, const std::vector<Real3> &points,
                             std::vector<Sample> *samples);

/// Means over planes of cells normal to `direction`, one for each cell along it, with velocities at cell centres. One
/// Allreduce.
PetscErrorCode sample_planes(const Domain &domain, const SampledFields &fields, int direction,
                             std::vector<Sample> *samples);

}  // namespace eulastic
