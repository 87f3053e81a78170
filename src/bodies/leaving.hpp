// Bodies that have come to a side of the box they leave through.
#pragma once

#include "field/phase.hpp"

#include <set>

namespace eulastic {

/// Cells beside a side that volume crosses where no body is.
constexpr int free_layers = 2;

/// Whether this rank has more phi than that in any cell within `layers` of a side.
bool has_solid(const Grid &grid, ConstView fraction, int d, bool high, int layers, double more_than);
/// Marks the labels of solid that this rank has there; what has no label (less than label_threshold) is gone at once.
void mark_leaving(const Grid &grid, int d, bool high, int layers, Phase *phase, std::set<int> *leaves);
/// Takes the marked bodies out of owned cells. What is around them is the caller's.
void take_out(const Grid &grid, const std::set<int> &leaves, Phase *phase);

}  // namespace eulastic
