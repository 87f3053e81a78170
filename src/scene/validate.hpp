// What no single option can know: whether the options fit together.
#pragma once

#include "scene/config.hpp"

namespace eulastic {

/// One line that names the option and what is accepted, or nothing. Looks for the files that are to be read, and places
/// the bodies.
std::string validate(Config *config);

}  // namespace eulastic
