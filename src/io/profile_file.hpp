// The velocity on a side of the box from the dataset `velocity` of an HDF5 file. Local to a rank.
#pragma once

#include <string>
#include <vector>

namespace eulastic {

/// Whether a file that begins so is one of HDF5.
bool is_hdf5(const std::string &bytes);

/// One number per cell of a side of `slow` rows of `fast` cells, row by row, from (slow, fast), the normal velocity
/// into the box, or from (slow, fast, 3), x, y, z, of which `component`, times `sign`, is taken; a single row may have
/// no dimension of its own. Returns what is wrong, or nothing.
std::string read_profile_file(const std::string &path, int slow, int fast, int component, double sign,
                              std::vector<double> *values);

}  // namespace eulastic
