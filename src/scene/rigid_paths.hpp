// Where rigid bodies travel during a run.
#pragma once

#include "bodies/shapes.hpp"
#include "scene/config.hpp"

namespace eulastic {

/// Of species that travel: empty, or one line: what they do not go with, or a path that comes too near a side of the
/// box, at any time of an oscillation or until -time_end. Bodies from files: check_path(), when their surface is known.
std::string check_paths(const Config &config);
/// Of one body.
std::string check_path(const Config &config, const SpeciesSpec &spec, const Surface &surface, const BodyPlace &place);

}  // namespace eulastic
