// What comes in through inflow sides of a box that has no open side.
#pragma once

#include "scene/config.hpp"

namespace eulastic {

/// The area of a side of direction d; in 2-D its length.
double area_of_side(const Config &config, int d);
/// Where no side is open the flow rates of all inflow sides must have the sum 0 at every time of the run, to round-off.
/// Empty, or one line.
std::string check_inflow_balance(const Config &config);

}  // namespace eulastic
