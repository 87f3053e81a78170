// Whether bonds can be what the options ask for.
#pragma once

#include "scene/config.hpp"

namespace eulastic {

/// One line, or nothing.
std::string check_adhesion(const Config &config);

}  // namespace eulastic
