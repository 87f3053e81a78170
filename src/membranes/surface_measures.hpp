// What is known of the surface of every membrane: its area, energies, and how fast it goes round.
#pragma once

#include "base/petsc.hpp"
#include "bodies/body_owners.hpp"
#include "field/phase.hpp"
#include "field/surface_marker.hpp"
#include "grid/domain.hpp"

namespace eulastic {

struct SurfaceMeasure {
  double area = 0;  ///< of the planes that transport cuts cells with; 2-D: length
  double shear_energy = 0, area_energy = 0, bending_energy = 0;
  /// Angular velocity at which material goes round in the xy plane, positive from x to y: the frequency of the linear
  /// flow that is nearest to that of the surface; 0 where that only strains. Of tank-treading and tumbling alike,
  /// whatever the shape.
  double turning_rate = 0;
  double area_strain = 0;      ///< mean, since the rest: area over that at rest, both from the strain, less 1
  double largest_stretch = 1;  ///< principal stretch along the surface, at cells beside it
};

/// Of the bodies that this rank owns; `references`: cells near the bodies that are here (BodyTracker::connect). One
/// ghost of phi. Exact sums. Collective.
PetscErrorCode measure_surfaces(const Domain &domain, const std::vector<Phase> &phases,
                                const std::vector<SurfaceSample> &samples, const BodyOwners &owners,
                                const std::vector<Int3> &references, std::vector<SurfaceMeasure> *bodies);
/// Of a body in a box of its own, from the samples at all its surface.
SurfaceMeasure measure_surface_in_box(const BodyInBox &body, const std::vector<SurfaceSample> &samples);

}  // namespace eulastic
