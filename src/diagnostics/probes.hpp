// Velocity, pressure and solid fraction at points, by linear interpolation from where each lives, and their means
// over planes of cells. The same bits on any number of ranks.
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

/// One ghost layer of all must be valid; phases are those at the time of the velocity.
struct SampledFields {
  const Field &velocity, &pressure;
  const std::vector<Phase> &phases;
};

/// At `points` of the box; z counts for nothing in 2-D. Second order; between a wall and the first centre the
/// pressure is extrapolated and the fraction constant. One Allreduce.
PetscErrorCode sample_points(const Domain &domain, const SampledFields &fields, const std::vector<Real3> &points,
                             std::vector<Sample> *samples);

/// Means over the planes of cells normal to `direction`, one per cell of it; velocities of the cells' centres.
PetscErrorCode sample_planes(const Domain &domain, const SampledFields &fields, int direction,
                             std::vector<Sample> *samples);

}  // namespace eulastic
