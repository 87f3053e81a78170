// Validation of the options of adhesion.
#pragma once

#include "scene/config.hpp"

namespace eulastic {

/// Reads the files of adhesive regions. Collective. Returns one line on what is wrong, or nothing.
std::string check_adhesion(Config *config);

}  // namespace eulastic
