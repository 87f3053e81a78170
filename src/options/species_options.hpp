// Rows of the option table for one species.
#pragma once

#include "options/option_rows.hpp"

namespace eulastic {

/// The name of the species is the prefix. With `from_state` the shape need not be given.
void add_species_rows(Rows &rows, SpeciesSpec &spec, bool from_state);

}  // namespace eulastic
