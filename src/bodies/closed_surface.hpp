// A body bounded by triangles: is it closed, which way round is it, and what part of every cell is inside?
//
// Exact, without rays: inside is what the triangles have on their low-x side, counted with the sign of their normal.
// Every triangle is cut by the faces of the cells; a piece in cell c adds the volume between itself and the high-x
// face of c to this cell, and its projected area to all cells behind. Volumes are added as integers, 2^-50 of a cell
// each: the same bits on any ranks.
#pragma once

#include "grid/voxels.hpp"

namespace eulastic {

/// Empty if every edge between two corners is used as often in one direction as in the other, so that the triangles
/// enclose a volume; else one sentence with the number of edges that are not. Corners are the same if their numbers
/// are.
std::string why_not_closed(const std::vector<Triangle> &triangles);

/// Volume enclosed; negative if the corners are in clockwise order.
double enclosed_volume(const std::vector<Triangle> &triangles);

/// Sets `fraction` of the cells of `window`, whose first one is (0,0,0) in it, to the part inside a closed surface in
/// box coordinates, either way round. What is outside the box is cut off; in 2-D the mean over z. Returns what is
/// wrong, or nothing: a surface that crosses itself.
std::string fill_surface(const CellWindow &window, const std::vector<Triangle> &triangles, View fraction);

}  // namespace eulastic
