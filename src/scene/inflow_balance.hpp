// Balance of the inflow in a box without open boundaries.
#pragma once

#include "scene/config.hpp"

namespace eulastic {

/// Without an open boundary the flow rates of all inflow boundaries must have the sum 0 at every time of the run, to
/// round-off. Returns an error of one line, or nothing.
std::string check_inflow_balance(const Config &config);

}  // namespace eulastic
