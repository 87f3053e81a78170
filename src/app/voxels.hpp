// Species of shape voxels: from the file to phi_0.
#pragma once

#include "app/config.hpp"
#include "bodies/placement.hpp"
#include "field/phase.hpp"

namespace eulastic {

/// One line on the first species whose file cannot be used, or nothing. Reads headers of volumes and all of a surface,
/// on every rank alike; single voxels are looked at by fill_voxels().
std::string why_not_voxels(const Config &config);

/// Collective. One body: sets the fraction, B and the label of a phase that fill_phase() made, and its place.
PetscErrorCode fill_voxels(const Grid &grid, const SpeciesSpec &spec, int label, Phase *phase,
                           std::vector<BodyPlace> *places);

}  // namespace eulastic
