// What -check_only and the start of a run say of the lumens at the sides that volume crosses.
#pragma once

#include "scene/config.hpp"

#include <string>
#include <vector>

namespace eulastic {

/// The largest mean velocity that is given on the open part of an inflow side.
double largest_inflow(const Config &config, int d, int high);
/// One line for every side that volume crosses and that is open: its open area, width and cells of its lumen, mean
/// velocity, flow rate, Reynolds number.
std::vector<std::string> side_lines(const Config &config);
/// One line on every lumen at such a side that is less than 8 cells wide or has a Reynolds number above 1e4, on every
/// open side that rigid bodies close, on every tube that fills nothing of the box and every body from a file that fills
/// all of it.
std::vector<std::string> lumen_warnings(const Config &config);

}  // namespace eulastic
