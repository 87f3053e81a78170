// The rows of the option table about sides that volume crosses.
#pragma once

#include "app/config.hpp"
#include "app/option_rows.hpp"

namespace eulastic {

void add_openings(Rows &rows, Config &config);

}  // namespace eulastic
