// Describes the lumens at inflow and open boundaries, for -check_only and the start of a run.
#pragma once

#include "scene/config.hpp"

#include <string>
#include <vector>

namespace eulastic {

/// The largest prescribed mean velocity on the open part of an inflow boundary.
double largest_inflow(const Config &config, int d, int high);
/// One line for every inflow or open boundary that is not closed by bodies: its open area, width and cells of its
/// lumen, mean velocity, flow rate, Reynolds number.
std::vector<std::string> side_lines(const Config &config);
/// One line for every lumen at such a boundary that is less than 8 cells wide or has a Reynolds number above 1e4, for
/// every open boundary that rigid bodies close, for every tube without a wall in the box and every body from a file
/// that fills the box.
std::vector<std::string> lumen_warnings(const Config &config);

}  // namespace eulastic
