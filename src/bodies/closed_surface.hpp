// A body bounded by triangles: whether it is closed, how it is oriented, and the solid fraction of every cell.
//
// The fractions are exact and need no rays: the inside is the sum of the volumes on the low-x side of the triangles,
// with the sign of their normals. Every triangle is cut by the cell faces; a piece in cell c adds the volume between it
// and the high-x face of c to this cell, and its projected area to all cells at higher x. Volumes are summed as
// integers in units of 2^-50 of a cell, so that the bits do not depend on the ranks.
#pragma once

#include "grid/voxels.hpp"

namespace eulastic {

/// Returns an empty string if every edge occurs equally often in both directions, so that the triangles enclose a
/// volume; otherwise one sentence with the number of unmatched edges. Corners are equal if their coordinates are.
std::string why_not_closed(const std::vector<Triangle> &triangles);

/// Returns the enclosed volume; it is negative if the corners are in clockwise order.
double enclosed_volume(const std::vector<Triangle> &triangles);

/// Sets `fraction` in the cells of `window` (indices relative to its first cell) to the fraction inside a closed
/// surface in coordinates of the domain, of either orientation. Parts outside the domain are cut off; in 2-D it is the
/// mean over z. Returns an empty string, or an error if the surface crosses itself.
std::string fill_surface(const CellWindow &window, const std::vector<Triangle> &triangles, View fraction);

}  // namespace eulastic
