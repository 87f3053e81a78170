// -NAME_stretch_force: both ends of a membrane are pulled apart along x, as optical tweezers do; docs/method.md, (27a).
#pragma once

#include "field/ghost_exchange.hpp"
#include "field/phase.hpp"
#include "field/surface_sample.hpp"

namespace eulastic {

/// Whether any phase is pulled.
bool bodies_are_stretched(const std::vector<Phase> &phases);

/// Forces along x per volume, of every sample; 0 where its material has no stretch force. On every body they add up to
/// plus that force at one end and minus it at the other. `references`: unwrapped cells near the bodies (BodyTracker).
/// Exact sums, four per cell along x and body; one Allreduce.
PetscErrorCode find_stretch_forces(const Grid &grid, const std::vector<SurfaceSample> &samples,
                                   const std::vector<Int3> &references, std::vector<double> *forces);
/// rate += scale times these at owned faces, half of each on either x face of its cell. `scratch`: a field.
PetscErrorCode add_stretch_forces(const Grid &grid, GhostExchange &exchange, const std::vector<SurfaceSample> &samples,
                                  const std::vector<double> &forces, double scale, FieldBlock &scratch,
                                  FieldBlock &rate);
/// What they do on the flow, at the velocities of the samples. Collective.
PetscErrorCode stretch_power(const Grid &grid, const std::vector<SurfaceSample> &samples,
                             const std::vector<double> &forces, double *power);

}  // namespace eulastic
