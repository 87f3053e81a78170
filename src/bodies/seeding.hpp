// Random placement of bodies without overlap, for a given number or hematocrit.
//
// Bodies start on random sites of a regular packing, which makes high hematocrits possible, and then move at random
// (hard-body Monte Carlo): to any free position, or else by small steps. Bodies for which the packing has no site are
// inserted at random; if that fails, all bodies are relaxed (bodies/relaxation.hpp).
#pragma once

#include "bodies/placement.hpp"
#include "bodies/solid_mask.hpp"

namespace eulastic {

/// Places the bodies of species[which] without overlap with walls, slabs, tubes, cylinders, `solids` and the bodies of
/// `earlier` (the species before it, all known). Membranes keep at least one cell from walls, for the film beside them.
/// The result depends on the arguments alone and is the same on all ranks. Returns an empty string, or one sentence on
/// the error; if the bodies do not fit, it says how many could be placed. `relax`: whether bodies that do not fit at
/// random are relaxed.
std::string seed_bodies(const std::vector<SpeciesSpec> &species, std::size_t which, const DomainShape &grid,
                        const SolidBodies &solids, const std::vector<Places> &earlier, std::vector<BodyPlace> *places,
                        bool relax = true);

}  // namespace eulastic
