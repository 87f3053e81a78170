// The rows of the option table about sides that volume crosses.
#pragma once

#include "options/option_rows.hpp"
#include "scene/config.hpp"

namespace eulastic {

void add_openings(Rows &rows, Config &config);

}  // namespace eulastic
