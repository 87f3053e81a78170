// Checks the paths of moving rigid bodies.
#pragma once

#include "bodies/shapes.hpp"
#include "scene/config.hpp"

namespace eulastic {

/// Returns nothing, or an error of one line about a moving species: an option that it cannot be combined with, or a
/// path that comes too close to a boundary of the box, at any time of an oscillation or until -time_end. Bodies from
/// files: check_path(), when their surface is known.
std::string check_paths(const Config &config);
/// The same for one body.
std::string check_path(const Config &config, const SpeciesSpec &spec, const Surface &surface, const BodyPlace &place);

}  // namespace eulastic
