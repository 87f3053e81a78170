// Where rigid bodies travel during a run.
#pragma once

#include "app/config.hpp"

namespace eulastic {

/// Of species that travel, whose places are known. Empty, or one line: what they do not go with, or a path that comes
/// too near a side of the box, at any time of an oscillation or until -time_end.
std::string check_paths(const Config &config);

}  // namespace eulastic
