// How many colours the bodies of a scene will need, from where they are placed.
#pragma once

#include "bodies/placement.hpp"

namespace eulastic {

/// Colours of bodies that are near, taken as seven cells or less between their surfaces (docs/method.md, section 15),
/// by colour_bodies(). Of more than 20000 bodies the first ones count. 1 for shapes without ends. Bodies that flow
/// pushes together need a few more.
int expected_colours(const SpeciesSpec &spec, const GridSpec &grid, const std::vector<BodyPlace> &places);

}  // namespace eulastic
