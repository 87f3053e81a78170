// Surfaces of triangles from STL files, binary or ascii.
#pragma once

#include "grid/voxels.hpp"

namespace eulastic {

/// Whether the content of a file is that of an STL file.
bool is_stl(const std::string &file);
/// Reads all solids of a file; normals are ignored, the order of the corners counts. Returns what is wrong, or nothing.
std::string read_stl(const std::string &file, std::vector<Triangle> *triangles);

}  // namespace eulastic
