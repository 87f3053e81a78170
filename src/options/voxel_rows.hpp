// Rows of the option table for bodies from files, and for -NAME_anchored.
#pragma once

#include "options/option_rows.hpp"

namespace eulastic {

void add_voxel_rows(Rows &rows, VoxelSpec &voxels);
void add_anchored_row(Rows &rows, SpeciesSpec &spec);

}  // namespace eulastic
