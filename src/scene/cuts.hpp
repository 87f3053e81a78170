// Cuts of a direction between ranks that balance their work.
#pragma once

#include <vector>

namespace eulastic {

/// Returns the first unit of each of `parts` ranks along a direction, followed by the number of units. `cost`: of every
/// unit of that direction, >= 0, at least `parts` times `least` entries; each rank has at least `least` units. The cuts
/// minimise the largest sum over a rank; among such cuts the sums are the most equal.
std::vector<int> equal_cuts(const std::vector<double> &cost, int parts, int least);

}  // namespace eulastic
