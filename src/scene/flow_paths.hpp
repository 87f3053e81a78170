// Ways of the fluid past rigid bodies, between the boundaries that it crosses.
#pragma once

#include "scene/config.hpp"

#include <string>

namespace eulastic {

/// Sets OpenPart::connected from the faces that rigid bodies close at t = 0. Bodies of -initial_state are left out, and
/// so are bodies that travel, which may open a way later, except for slabs. Collective. Returns an error of a file, or
/// nothing.
std::string find_connected_boundaries(Config *config);

}  // namespace eulastic
