// The velocity on a side of the box from an HDF5 file. Local to a rank.
#pragma once

#include <string>
#include <vector>

namespace eulastic {

/// From `dataset`, or if this is empty from `velocity` or the only one of the file: one number per cell of a side of
/// `slow` rows of `fast` cells, row by row, from (slow, fast), the normal velocity into the box, or from (slow, fast,
/// 3), x, y, z, of which `component`, times `sign`, is taken; a single row may have no dimension of its own. Returns
/// what is wrong, or nothing.
std::string read_profile_file(const std::string &path, const std::string &dataset, int slow, int fast, int component,
                              double sign, std::vector<double> *values);

}  // namespace eulastic
