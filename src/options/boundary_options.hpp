// Rows of the option table for the boundaries of the box.
#pragma once

#include "options/option_rows.hpp"

namespace eulastic {

/// Kinds of all boundaries, and what is prescribed on them.
void add_boundaries(Rows &rows, Config &config);

}  // namespace eulastic
