// Where a direction is cut between ranks so that they have about as much to do.
#pragma once

#include <vector>

namespace eulastic {

/// First unit of each of `parts` ranks along a direction, and the number of units at the end. `cost`: of every unit of
/// that direction, >= 0, at least `parts` times `least`, which is how many each rank has or more. The largest sum over
/// a rank is the least that there is, but for what `least` takes; within that the cuts are where sums are most equal.
std::vector<int> equal_cuts(const std::vector<double> &cost, int parts, int least);

}  // namespace eulastic
