// Checks whether the options are consistent with each other.
#pragma once

#include "scene/config.hpp"

namespace eulastic {

/// Refuses a boundary that is not periodic opposite one that is. Returns an error of one line, or nothing.
std::string check_single_sides(const Config &config);
/// Returns an error of one line that names the option and what is accepted, or nothing. Checks that input files exist,
/// and places the bodies.
std::string validate(Config *config);

}  // namespace eulastic
