// How many colours the bodies of a scene will need, from where they are placed.
#pragma once

#include "bodies/placement.hpp"

namespace eulastic {

inline constexpr int expected_colours_of = 20000;  ///< bodies

/// Colours of bodies that are near, taken as seven cells or less between their surfaces (docs/method.md, section 15),
/// by colour_bodies(). Of many bodies the first ones count, which must be known. 1 for shapes without ends. Bodies that
/// flow pushes together need a few more.
int expected_colours(const SpeciesSpec &spec, const DomainShape &grid, const Places &places);

}  // namespace eulastic
