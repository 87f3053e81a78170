// Measures of the surface of every membrane: area, energies, and rate of rotation.
#pragma once

#include "base/petsc.hpp"
#include "bodies/body_owners.hpp"
#include "field/phase.hpp"
#include "field/surface_marker.hpp"
#include "grid/domain.hpp"

namespace eulastic {

struct SurfaceMeasure {
  double area = 0;  ///< of the planes by which transport cuts cells; 2-D: length
  double shear_energy = 0, area_energy = 0, bending_energy = 0;
  /// Angular velocity at which material rotates in the xy plane, positive from x to y: the frequency of the linear flow
  /// that is closest to the velocity of the surface, 0 where that flow only strains. It covers tank-treading and
  /// tumbling, for any shape.
  double turning_rate = 0;
  double area_strain = 0;      ///< area over undeformed area, both from the strain, minus 1; mean
  double largest_stretch = 1;  ///< principal stretch along the surface in the cells beside it
};

/// Measures the bodies that this rank owns. `references`: reference cells of the bodies with cells on this rank
/// (BodyTracker::connect). Reads one ghost of phi. Sums are exact. Collective.
PetscErrorCode measure_surfaces(const Domain &domain, const std::vector<Phase> &phases,
                                const std::vector<SurfaceSample> &samples, const BodyOwners &owners,
                                const std::vector<Int3> &references, std::vector<SurfaceMeasure> *bodies);
/// Measures a body in a box of its own, from samples of its whole surface.
SurfaceMeasure measure_surface_in_box(const BodyInBox &body, const std::vector<SurfaceSample> &samples);

}  // namespace eulastic
