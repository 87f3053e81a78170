// What no single option can know: whether the options fit together.
#pragma once

#include "app/config.hpp"

namespace eulastic {

/// One line that names the option and what is accepted, or nothing. Looks for the files that are to be read.
std::string validate(const Config &config);

}  // namespace eulastic
