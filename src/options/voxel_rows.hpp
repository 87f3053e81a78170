// Rows of the option table for bodies from files, and for what is attached.
#pragma once

#include "options/option_rows.hpp"

namespace eulastic {

void add_voxel_rows(Rows &rows, VoxelSpec &voxels);
void add_attached_row(Rows &rows, SpeciesSpec &spec);

}  // namespace eulastic
