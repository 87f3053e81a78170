// Species of shape voxels: from the file to phi_0.
#pragma once

#include "base/petsc.hpp"
#include "bodies/placement.hpp"
#include "bodies/solid_mask.hpp"
#include "field/phase.hpp"
#include "grid/domain.hpp"
#include "scene/config.hpp"

#include <functional>

namespace eulastic {

using VisitLayers = std::function<void(const CellWindow &, ConstView fraction)>;

/// Solid fractions that a file has of some cells of the box, some layers at a time. Collective, each rank with its
/// cells; ends on all ranks when something is wrong on one. Returns one line on what is wrong here, which names the
/// option, or nothing.
std::string read_cells(const VoxelSpec &voxels, const std::string &option, const DomainShape &grid,
                       const CellWindow &cells, const VisitLayers &visit);
/// The same of a species of shape voxels.
std::string read_voxels(const SpeciesSpec &spec, const DomainShape &grid, const CellWindow &cells,
                        const VisitLayers &visit);

/// Measures the species of shape voxels: `volumes` gets the volume of each in the box (0 for other shapes), `solids`
/// its sum and, with `masks`, the cells. Returns an error of one line if a species has no solid in the box, or is rigid
/// and fills all of it; else nothing. Collective.
std::string measure_voxels(const std::vector<SpeciesSpec> &species, const DomainShape &grid, bool masks,
                           SolidBodies *solids, std::vector<double> *volumes);

/// Collective. One body: sets the fraction, B and the label of a phase that fill_phase() made, and its place.
PetscErrorCode fill_voxels(const Domain &domain, const SpeciesSpec &spec, int label, Phase *phase, Places *places);

}  // namespace eulastic
