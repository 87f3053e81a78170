// Random bodies without overlap, for a number or a hematocrit.
//
// They start on random sites of a regular packing, which is what makes high hematocrits possible, then move at random
// (hard-body Monte Carlo): anywhere if there is room, else by steps. What the packing cannot hold is tried at random;
// if it does not fit so, all are relaxed (bodies/relaxation.hpp).
#pragma once

#include "bodies/placement.hpp"
#include "bodies/solid_mask.hpp"

namespace eulastic {

/// Places species[which], clear of walls, slabs, tubes, cylinders, `solids` and of the bodies of `earlier` (those of
/// the species before, all known); membranes by a cell at least, which the film beside walls takes. Depends on nothing
/// but the arguments: every rank finds the same. Returns an empty string, or one sentence on what is wrong; where they
/// do not fit, with how many could be placed.
std::string seed_bodies(const std::vector<SpeciesSpec> &species, std::size_t which, const DomainShape &grid,
                        const SolidBodies &solids, const std::vector<Places> &earlier, std::vector<BodyPlace> *places);

}  // namespace eulastic
